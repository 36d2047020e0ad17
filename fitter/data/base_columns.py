"""The base's columns of a motion, and how frame 0 moves by them."""

from dataclasses import replace

import numpy as np
import scipy

from arm.base_pose import frame_0_poses
from arm.model import Arm, Floats
from arm.moving_base import BaseState, standing_base
from limbcal.errors import DataError

#: Samples that a quintic spline needs.
LEAST_SAMPLES = 6
#: How far a quaternion may be from length one.
_LENGTH = 1e-3


def derivatives(t: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return first and second derivative of columns on their own times: those of the quintic spline through them.

    Parameters
    ----------
    t : (n_sample,) [s]
    values : (n_sample, n)

    Raises
    ------
    DataError
        If there are too few samples.
    """
    if len(t) < LEAST_SAMPLES:
        raise DataError(f"a trial has {len(t)} samples, expected at least {LEAST_SAMPLES} to differentiate")
    spline = scipy.interpolate.make_interp_spline(t, values, k=5, axis=0)
    return np.asarray(spline(t, nu=1)), np.asarray(spline(t, nu=2))


def base_state(arm: Arm, t: Floats, columns: Floats | None, where: str) -> BaseState:
    """Return how frame 0 moves: with the base's columns, then as [base] has it.

    Parameters
    ----------
    arm : Arm
    t : (n_sample,) [s]
    columns : (n_sample, 7) or None
        As `protocol.tables.columns.BASE_ROLES`; without them the base stands where [base] has it.
    where : str
        The file, for errors.

    Raises
    ------
    DataError
        If a quaternion is not of length one.
    """
    if columns is None:
        R, p = frame_0_poses(arm, None)
        return replace(standing_base(len(t)), R=np.tile(R, (len(t), 1, 1)), p=np.tile(p, (len(t), 1)))
    length = np.linalg.norm(columns[:, 3:], axis=1)
    if np.any(np.abs(length - 1.0) > _LENGTH):
        row = int(np.argmax(np.abs(length - 1.0)))
        raise DataError(f"{where}: base_qw … base_qz has length {length[row]:.4g} in row {row + 1}, expected 1")
    quaternion = columns[:, 3:] / length[:, None]
    flips = np.where(np.sum(quaternion[1:] * quaternion[:-1], axis=1) < 0.0, -1.0, 1.0)
    quaternion = quaternion * np.cumprod(np.concatenate([[1.0], flips]))[:, None]  # q and -q are one turn
    rate, second = derivatives(t, quaternion)
    conjugate = quaternion * np.array([1.0, -1.0, -1.0, -1.0])
    omega = 2.0 * _vector_of_product(rate, conjugate)
    omega_dot = 2.0 * _vector_of_product(second, conjugate)  # that of dq dq* is a scalar
    _, acceleration = derivatives(t, columns[:, :3])
    R, p = frame_0_poses(arm, np.hstack([columns[:, :3], quaternion]))
    lever = p - columns[:, :3]
    swing = np.cross(omega_dot, lever) + np.cross(omega, np.cross(omega, lever))
    return BaseState(R, p, omega, omega_dot, acceleration + swing)


def _vector_of_product(a: Floats, b: Floats) -> Floats:
    """Return the vector parts of products of quaternions w, x, y, z, (n, 4)."""
    return a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
