"""Where frame 0 is in the world: the pose of the segment that carries it, then [base]."""

import numpy as np
from scipy.spatial.transform import Rotation

from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats


def is_carried(arm: Arm) -> bool:
    """Whether a tracked segment carries the arm, so that its base has six coordinates of its own."""
    return arm.base is not None and arm.base.segment is not None


def gravity_in_world(arm: Arm) -> Floats:
    """Return gravity in the world's axes, (3,) [m/s²].

    A file has it in the world where a segment carries the arm, and otherwise in frame 0.
    """
    gravity = np.array(arm.gravity_m_s2)
    turned: Floats = gravity if is_carried(arm) else base_in_segment(arm)[0] @ gravity
    return turned


def base_in_segment(arm: Arm) -> tuple[Floats, Floats]:
    """Return frame 0 in the segment that carries it, or in the world: R (3, 3) and p (3,) [m]."""
    if arm.base is None:
        return np.eye(3), np.zeros(3)
    return rotation_from_rpy(*arm.base.rotation_rad), np.array(arm.base.position_m)


def frame_0_poses(arm: Arm, columns: Floats | None) -> tuple[Floats, Floats]:
    """Return frame 0 in the world, R (n_sample, 3, 3) and p (n_sample, 3) [m].

    Parameters
    ----------
    arm : Arm
    columns : (n_sample, 7), or None
        The segment's pose in the world: place [m], then a unit quaternion w x y z. Without it the base stands, and
        there is one sample.
    """
    own_R, own_p = base_in_segment(arm)
    if columns is None:
        return own_R[None], own_p[None]
    R = Rotation.from_quat(columns[:, 3:], scalar_first=True).as_matrix()
    return R @ own_R, columns[:, :3] + R @ own_p
