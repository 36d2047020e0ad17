"""Where optical markers on an arm are at given joint values."""

import numpy as np

from arm.kinematics import axis_frames
from arm.model import Arm, Floats


def marker_positions(arm: Arm, q: Floats) -> Floats:
    """Return where an arm has its markers in frame 0.

    Parameters
    ----------
    arm : Arm
    q : (n_sample, n_joint) [rad or m]

    Returns
    -------
    (n_sample, n_marker, 3) [m]
        In the order of the arm's markers; those of link 0 stand.
    """
    frames = axis_frames(arm, q)
    frames = np.concatenate([np.tile(np.eye(4), (len(q), 1, 1, 1)), frames], axis=1)
    own = frames[:, [marker.joint for marker in arm.markers]]
    local = np.array([marker.position_m for marker in arm.markers]).reshape(-1, 3)
    return np.asarray(np.einsum("nmij,mj->nmi", own[..., :3, :3], local) + own[..., :3, 3])
