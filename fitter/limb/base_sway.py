"""The base's pose once the limb has had its say: by how much its markers miss the joint that they carry, shared out.

That the base is to shift by ``δ`` at the joint, a distance ``d`` from the middle of its markers, is most likely when
its markers err alike: with the covariance of their pose, ``t = C_t C^-1 δ`` and ``w = C_w [d] C^-1 δ``, where
``C = C_t + [d] C_w [d]^T`` (`fitter.functional.pose_error`).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from arm.model import Floats


def shared_out(points_m: Floats, at_m: Floats, shift_m: Floats, R: Floats, p: Floats) -> tuple[Floats, Floats]:
    """Return the poses of the base's segment whose joint is shifted, with the least error of its markers.

    Parameters
    ----------
    points_m : (n_marker, 3)
        Of the base, in its segment's frame; of fewer than three the whole shift is a translation.
    at_m : (3,)
        The joint, there.
    shift_m : (n_frame, 3)
        By how much, in the segment's axes.
    R, p : (n_frame, 3, 3), (n_frame, 3)
        Segment to world.
    """
    if len(points_m) < 3:
        return R, p + np.einsum("nij,nj->ni", R, shift_m)
    middle = points_m.mean(axis=0)
    x = points_m - middle
    J = np.sum(x**2) * np.eye(3) - x.T @ x
    d = _cross(at_m - middle)
    own, turned = np.eye(3) / len(points_m), np.linalg.inv(J)
    by = np.linalg.solve(own + d @ turned @ d.T, shift_m.T)
    t, w = (own @ by).T, (turned @ d @ by).T
    turn = Rotation.from_rotvec(w).as_matrix()
    moved = middle - np.einsum("nij,j->ni", turn, middle) + t
    return R @ turn, p + np.einsum("nij,nj->ni", R, moved)


def _cross(d: Floats) -> Floats:
    return np.array([[0.0, -d[2], d[1]], [d[2], 0.0, -d[0]], [-d[1], d[0], 0.0]])
