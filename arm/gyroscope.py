"""What an ideal triaxial gyroscope on a link reads."""

import numpy as np

from arm.chain import chain_of, motion_rows
from arm.kinematics import frames_of, rotation_from_rpy
from arm.model import Arm, Floats


def angular_velocity(arm: Arm, q: Floats, dq: Floats) -> Floats:
    """Return the angular velocity of the link of every gyroscope, in its sensor's own axes.

    It is the sum of the joints' axes times their speeds, over the joints that turn between the base and the link.

    Parameters
    ----------
    arm : Arm
    q, dq : (n_sample, n_joint) [rad or m, and derivative]

    Returns
    -------
    (n_sample, n_gyroscope, 3) [rad/s]
        Of the sensors that have a gyroscope, in the arm's order.
    """
    q, dq = motion_rows(arm, q=q, dq=dq)
    R = frames_of(chain_of(arm), q)[:, :, :3, :3]
    turns = np.array([joint.type == "revolute" for joint in arm.joints])
    of_joint = R[..., 2] * (dq * turns)[..., None]  # z of a link is the axis of its joint
    read = np.empty((len(q), len(arm.gyroscopes), 3))
    for k, s in enumerate(arm.gyroscopes):
        sensor = arm.sensors[s]
        omega = of_joint[:, arm.way_to(sensor.joint - 1)].sum(axis=1)
        axes = R[:, sensor.joint - 1] @ rotation_from_rpy(*sensor.rotation_rad)
        read[:, k] = np.einsum("nij,ni->nj", axes, omega)
    return read
