"""What no rest can change of an arm's readings, and by how much drifting angles may change the others."""

import numpy as np

from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from tracking.dead_reckoning.integration_state import Reckoning

#: By how much an integrated angle may be off, when it is asked whether gravity explains a reading.
_ANGLE_DRIFT_RAD = np.deg2rad(2.0)


def gravity_slack(arm: Arm, state: Reckoning) -> Floats:
    """Return how much a drift of the angles may change what gravity shows, (3 * n_sensor,) [m/s^2]."""
    if all(joint.type == "prismatic" for joint in arm.joints):
        return np.zeros(3 * len(state.link))
    axes = axis_frames(arm, state.q)[0, :, :3, 2]
    tilt = np.linalg.norm(np.cross(axes, arm.gravity_m_s2), axis=1)  # 0 for an axis along gravity
    turning = np.array([joint.type == "revolute" for joint in arm.joints])
    per_link = np.cumsum(tilt * turning) * _ANGLE_DRIFT_RAD
    return np.repeat(per_link[state.link], 3)


def contrasts(state: Reckoning) -> Floats:
    """Return the differences of the two sensors of each pair, in link axes: no rest can change them.

    Returns
    -------
    ndarray
        (n_contrast, 3 * n_sensor)
    """
    rows = []
    for one, two in state.pair:
        if one != two:
            row = np.zeros((3, 3 * len(state.link)))
            row[:, 3 * two : 3 * two + 3] = state.rotation[two]
            row[:, 3 * one : 3 * one + 3] = -state.rotation[one]
            rows.append(row)
    return np.vstack(rows) if rows else np.zeros((0, 3 * len(state.link)))
