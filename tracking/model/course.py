"""Readings at the rate of the frames, and what is held of each instant."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from tracking.model.process_noise import FILTER_PUSH_STD, SMOOTHER_PUSH_STD, WANDER_STD
from tracking.model.readings import Readings


class Course(NamedTuple):
    """Readings at the filter's rate, and what is held of each instant.

    Attributes
    ----------
    dt : float [s]
    readings : (n, n_channel) [m/s^2, of gyroscopes rad/s]
    present : (n,) bool
        False where the readings were lost.
    noise : (n_channel,)
        Variance of a reading.
    wander : (n_channel,)
        By how much the variance of an offset grows in a second.
    push : (n_joint,)
        By how much the variance of an acceleration grows in a second.
    jolt : (n, n_joint)
        Variance of what an acceleration jumped by from the instant before, beyond that.
    doubt : (n, n_channel)
        Factor on the noise of the readings.
    rest : (n, n_joint)
        Variance with which a joint's velocity is zero; 0 where nothing is known of it.
    base_std : float [m/s^2]
        Standard deviation of each axis of the base's acceleration; it counts where the observation has one.
    lack_std : (n_channel,)
        Standard deviation of what the model lacks of a reading; it counts where the observation has that.
    memory_s : float [s]
        Time constant of both.
    rate : (n_joint,) [1/s]
        Of each joint's speed as a stationary process; 0 where it is the integral of its acceleration.
    drift : (n, n_channel) [m/s^3, of gyroscopes rad/s^2]
        Rate of each reading; it counts where the observation has clocks.
    """

    dt: float
    readings: Floats
    present: NDArray[np.bool_]
    noise: Floats
    wander: Floats
    push: Floats
    jolt: Floats
    doubt: Floats
    rest: Floats
    rate: Floats
    base_std: float = 0.0
    lack_std: Floats = np.zeros(0)
    memory_s: float = 1.0
    drift: Floats = np.zeros((0, 0))


def course_of(readings: Readings, n_joint: int) -> Course:
    """Return readings as a course of which nothing more is known."""
    n = len(readings.values)
    # Nobody saw a jolt where readings are missing, so there may have been one.
    jolt = np.where(readings.present, 0.0, SMOOTHER_PUSH_STD**2 * readings.dt_s)
    noise = readings.noise.of_mean(readings.factor)
    return Course(
        readings.dt_s,
        np.ascontiguousarray(np.nan_to_num(readings.values)),  # what is not present is not looked at
        readings.present,
        noise,
        WANDER_STD**2 + readings.noise.rounding,
        np.full(n_joint, FILTER_PUSH_STD**2),
        np.repeat(jolt[:, None], n_joint, axis=1),
        np.ones(readings.values.shape),
        np.zeros((n, n_joint)),
        np.zeros(n_joint),
    )
