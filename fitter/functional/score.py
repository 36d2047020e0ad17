"""SCoRE: the centre of a joint that is fixed in both segments (Ehrig, Taylor, Duda, Heller 2006).

``(u, v)`` minimises ``sum |R u + p - S v - q|²`` over the frames. Along a direction that the motion turns about no
other axis only the difference of ``u`` and ``v`` is seen; the sum is then left at zero, which is the point of a
hinge's axis halfway between the two segments' origins.

Symmetrical weighting: each frame's three equations have the inverse of the covariance of both poses at the centre
(`pose_error`), so that a segment whose markers are far from the joint, few, or wandering has less say where it
knows less; the centre in the world is the mean of both with the same weights.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.relative_motion import PartSums, Turning


def revealed_basis(turning: Turning, unobservable: NDArray[np.bool_]) -> Floats:
    """Return an orthonormal basis of what the motion reveals of ``(u, v)``, (6, 6 - n_unobservable).

    Parameters
    ----------
    turning : Turning
    unobservable : (3,) bool
        Along which of its directions the centre is not revealed.
    """
    sums = np.hstack([turning.in_parent, turning.in_child]) / np.sqrt(2.0)
    differences = np.hstack([turning.in_parent, -turning.in_child]) / np.sqrt(2.0)
    return np.asarray(np.vstack([sums[~unobservable], differences]).T)


def centre(sums: PartSums, use: NDArray[np.bool_], basis: Floats) -> Floats:
    """Return ``(u, v)``, (6,) [m]: the centre in the parent's and in the child's frame.

    Parameters
    ----------
    sums : PartSums
    use : (n_part,) bool
        Which parts to use.
    basis : (6, n)
        Of what is revealed, `revealed_basis`.
    """
    gram = basis.T @ sums.gram[use].sum(axis=0) @ basis
    return np.asarray(basis @ np.linalg.solve(gram, basis.T @ sums.rhs[use].sum(axis=0)))
