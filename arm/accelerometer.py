"""What an ideal triaxial accelerometer on a link reads."""

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, chain_of, motion_rows, poses
from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats
from arm.newton_euler import rigid_motion
from limbcal.compiled import compiled


def specific_force(arm: Arm, q: Floats, dq: Floats, ddq: Floats) -> Floats:
    """Return the specific force at every sensor, in the sensor's own axes.

    It is acceleration minus gravity: a sensor at rest reads ``+g`` upwards.

    Parameters
    ----------
    arm : Arm
    q, dq, ddq : (n_sample, n_joint) [rad or m, and derivatives]

    Returns
    -------
    (n_sample, n_sensor, 3) [m/s^2]
    """
    q, dq, ddq = motion_rows(arm, q=q, dq=dq, ddq=ddq)
    joint = np.array([sensor.joint - 1 for sensor in arm.sensors], dtype=np.int64)
    position = np.array([sensor.position_m for sensor in arm.sensors], dtype=float).reshape(-1, 3)
    rotation = np.array([rotation_from_rpy(*sensor.rotation_rad) for sensor in arm.sensors]).reshape(-1, 3, 3)
    force = np.empty((len(q), len(arm.sensors), 3))
    _specific_forces(chain_of(arm), joint, position, rotation, q, dq, ddq, force)
    return force


@compiled
def _specific_forces(
    chain: Chain,
    joint: NDArray[np.int64],
    position: Floats,
    rotation: Floats,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    force: Floats,
) -> None:
    n = q.shape[1]
    R, p, motion, a = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3, 3)), np.empty(3)
    for k in range(q.shape[0]):
        poses(chain, q[k], R, p)
        rigid_motion(chain, chain.gravity, R, p, dq[k], ddq[k], motion)
        for s in range(joint.size):
            w, dw, dv = motion[joint[s], 0], motion[joint[s], 1], motion[joint[s], 2]
            x, y, z = position[s, 0], position[s, 1], position[s, 2]
            along = w[0] * x + w[1] * y + w[2] * z
            square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
            # dv + dw x s + w x (w x s), with w x (w x s) = w (w.s) - s (w.w)
            a[0] = dv[0] + dw[1] * z - dw[2] * y + w[0] * along - x * square
            a[1] = dv[1] + dw[2] * x - dw[0] * z + w[1] * along - y * square
            a[2] = dv[2] + dw[0] * y - dw[1] * x + w[2] * along - z * square
            for row in range(3):
                force[k, s, row] = (
                    rotation[s, 0, row] * a[0] + rotation[s, 1, row] * a[1] + rotation[s, 2, row] * a[2]
                )
