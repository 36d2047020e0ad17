"""How far turns of the skin draw a centre towards the markers.

Skin turns a cluster about the bone by some degrees. With a turn of variance ``e²`` about each axis the mean of the
measured rotations is ``1 - e²`` of the true mean, whatever the turns hang together with in time; SCoRE then sees a
joint that turns more than it does, and finds a centre too near to the markers, by a share of about ``2 e²`` of
what turned squared. More frames do not help, and disjoint trials agree in it. How large ``e²`` is shows in the
distance of both segments' centres: a turn moves them across the lever from the markers, a shift alike in all
directions:

    E g g^T = s² I + e_child² S (|v|² I - v v^T) S^T + e_parent² R (|u|² I - u u^T) R^T

The answer stays SCoRE's. What it would be without the attenuation is how far its error goes beyond what trials
show.
"""

import numpy as np
import scipy

from arm.model import Floats
from fitter.functional.relative_motion import RelativeMotion, part_sums, turning

#: Largest share of what turned least that is put down to skin: what is more is no small noise in the regressor.
_LARGEST_SHARE = 0.5


def skin_turns(motion: RelativeMotion, both_m: Floats) -> tuple[float, float]:
    """Return the variance of the parent's and of the child's turns about each axis [rad²].

    Parameters
    ----------
    motion : RelativeMotion
    both_m : (6,)
        The centre in the parent's and in the child's frame, whose origins are in the middle of the markers.
    """
    gap = np.einsum("nij,j->ni", motion.R, both_m[:3]) + motion.p
    gap -= np.einsum("nij,j->ni", motion.S, both_m[3:]) + motion.q
    across = [np.broadcast_to(np.eye(3), motion.R.shape)]
    for turned, lever in ((motion.R, both_m[:3]), (motion.S, both_m[3:])):
        across.append(turned @ (lever @ lever * np.eye(3) - np.outer(lever, lever)) @ turned.transpose(0, 2, 1))
    size = np.array([np.sqrt(np.mean(np.sum(one**2, axis=(1, 2)))) for one in across])
    gram = np.array([[np.einsum("nij,nij->", a, b) for b in across] for a in across]) / np.outer(size, size)
    seen = np.array([np.einsum("ni,nij,nj->", gap, one, gap) for one in across]) / size
    # least squares over the nine elements of all frames, by a square root of its normal equations
    values, axes = np.linalg.eigh(gram)
    root = np.sqrt(np.maximum(values, values[-1] * 1e-9))
    variances = scipy.optimize.nnls(root[:, None] * axes.T, axes.T @ seen / root)[0] / size
    return float(variances[1]), float(variances[2])


def without_attenuation(motion: RelativeMotion, turns_rad2: tuple[float, float], basis: Floats) -> Floats:
    """Return SCoRE's ``(u, v)``, (6,) [m], with the mean rotations as they were before skin turned.

    Parameters
    ----------
    motion : RelativeMotion
    turns_rad2 : tuple of float
        Variance of the parent's and of the child's turns about each axis.
    basis : (6, n)
        Of what is revealed.
    """
    sums = part_sums(motion, np.zeros(motion.n_frame, dtype=np.intp))
    gram, rhs = sums.gram[0].copy(), sums.rhs[0].copy()
    n_unobservable = 6 - basis.shape[1]
    least = _LARGEST_SHARE * (1.0 - turning(gram).sigma[n_unobservable])
    total = max(sum(turns_rad2), 1e-12)
    parent, child = (1.0 - turn * min(1.0, least / total) for turn in turns_rad2)
    gram[:3, 3:] /= parent * child
    gram[3:, :3] /= parent * child
    rhs[:3] /= parent
    rhs[3:] /= child
    return np.asarray(basis @ np.linalg.solve(basis.T @ gram @ basis, basis.T @ rhs))
