"""SARA: the axis of a joint that is fixed in both segments (Ehrig, Taylor, Duda, Heller 2007).

Its direction, ``a`` in the parent and ``b`` in the child, minimises ``sum |R a - S b|²`` at length one: the last
right singular vector of the matrix of SCoRE, which is the first pair of singular vectors of the mean relative
rotation. Both halves are then of the same length by themselves. A point of the axis is what SCoRE finds.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.relative_motion import PartSums, turning


def axis(sums: PartSums, use: NDArray[np.bool_], like: Floats | None = None) -> Floats:
    """Return ``(a, b)``, (6,): the unit direction in the parent's and in the child's frame.

    Parameters
    ----------
    sums : PartSums
        Unweighted.
    use : (n_part,) bool
        Which parts to use.
    like : (6,), optional
        A direction that settles the sign.
    """
    turned = turning(sums.gram[use].sum(axis=0))
    found = np.concatenate([turned.in_parent[0], turned.in_child[0]])
    return found if like is None or found @ like >= 0.0 else -found
