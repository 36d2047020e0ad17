"""How far the pose of a segment may be off at a point, as the residuals of its markers have it.

Markers that wander independently with variance ``s²`` leave the pose, at a place ``d`` from the mean of the seen
markers, with the covariance ``s² (I/m + [d] J^-1 [d]^T)``, ``J = sum(|x|² I - x x^T)`` (Söderkvist and Wedin 1993;
Woltring et al. 1985). It is a weight between frames, directions and segments, and never an error that is stated:
skin does not wander independently.
"""

import numpy as np

from arm.model import Floats
from fitter.functional.rigid_fit import LEAST_WIDTH_M, Poses

#: A marker's noise at the least [m], rms along each axis: some tenths of a millimetre, as makers of optical
#: systems state it. It only keeps the weights finite where data are free of noise.
_LEAST_NOISE_M = 2e-4


def marker_variance(poses: Poses) -> float:
    """Return the variance along each axis [m²] that the residuals of a segment's markers show."""
    seen = np.isfinite(poses.residual_m[..., 0])
    freedom = np.maximum(3 * seen.sum(axis=1) - 6, 0)  # a pose takes six of a frame's equations
    total = freedom[poses.valid].sum()
    squares = np.where(seen, np.sum(np.nan_to_num(poses.residual_m) ** 2, axis=2), 0.0)[poses.valid].sum()
    return max(squares / total if total else 0.0, _LEAST_NOISE_M**2)


def pose_covariance(points_m: Floats, poses: Poses, at_m: Floats, variance: float) -> Floats:
    """Return the covariance of where the poses have a point, in the segment's frame, (n_frame, 3, 3) [m²].

    Parameters
    ----------
    points_m : (n_marker, 3)
        The template.
    poses : Poses
    at_m : (3,)
        The point, in the segment's frame.
    variance : float
        Of a marker along each axis [m²].
    """
    m, mean, J_inverse = _spread(points_m, poses)
    X = _cross(at_m - mean)
    return np.asarray(variance * (np.eye(3) / m[:, None, None] + X @ J_inverse @ X.transpose(0, 2, 1)))


def turn_variance(points_m: Floats, poses: Poses, variance: float) -> float:
    """Return the variance of the orientation about an axis [rad²], in the mean of the frames and of the axes."""
    J_inverse = _spread(points_m, poses)[2][poses.valid]
    return float(variance * np.trace(J_inverse, axis1=1, axis2=2).mean() / 3.0) if len(J_inverse) else np.nan


def _spread(points_m: Floats, poses: Poses) -> tuple[Floats, Floats, Floats]:
    """Return the number of seen markers, their mean, and the inverse of ``J``, of each frame."""
    seen = np.isfinite(poses.residual_m[..., 0])
    m = np.maximum(seen.sum(axis=1), 1).astype(np.float64)
    local = np.nan_to_num(points_m)
    mean = seen @ local / m[:, None]
    x = np.where(seen[..., None], local - mean[:, None, :], 0.0)
    outer = np.einsum("nmi,nmj->nij", x, x)
    J = np.trace(outer, axis1=1, axis2=2)[:, None, None] * np.eye(3) - outer
    # of frames without a pose J may be singular; they have no place in any sum
    return m, mean, np.linalg.inv(np.where(poses.valid[:, None, None], J, np.eye(3) * LEAST_WIDTH_M**2))


def _cross(d: Floats) -> Floats:
    """Return the matrices of the cross product with vectors, (n, 3) to (n, 3, 3)."""
    x, y, z = d.T
    o = np.zeros_like(x)
    return np.array([[o, -z, y], [z, o, -x], [-y, x, o]]).transpose(2, 0, 1)
