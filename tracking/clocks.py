"""Sensors whose clocks differ: each reading is of a little earlier or later than its stamp says.

A sensor that is late by c reads h(t - c) at t. Its readings are moved back by what is known of c, and what is left of it
is a constant of the state, whose slope is -dh/dt (as in calibrating the clocks of cameras and inertial sensors;
P. Furgale, J. Rehder, R. Siegwart, *Unified temporal and spatial calibration for multi-sensor systems*, 2013). Only
differences show: the first sensor's clock is the one that counts.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_filter

from arm.model import Floats
from tracking.course import Course
from tracking.observation import ABSENT, Observation

#: How far clocks of sensors of one recording are apart [s]: a few packets.
CLOCK_STD_S = 0.03
#: Readings are moved anew where a clock is off by more than this fraction of its standard deviation, a convention.
CLOCK_STEP = 0.1
#: Over how long a reading's rate is taken [s]: noise shows a hundredth in it of what a motion of a hertz does.
_WINDOW_S = 0.1
#: Degree of the polynomial whose slope it is.
_DEGREE = 2


class Clocks(NamedTuple):
    """By how much each sensor is later than the first one, and how well that is known; (n_sensor,) each [s]."""

    late_s: Floats
    std_s: Floats


def start_clocks(x: Floats, P: Floats, columns: NDArray[np.int64]) -> None:
    """Put what is held of the clocks before the first reading into a state and its covariance."""
    x[columns] = 0.0
    P[columns], P[:, columns] = 0.0, 0.0
    P[columns, columns] = CLOCK_STD_S**2


def clocks_of(of: Observation, late_s: Floats, x: Floats, P: Floats) -> Clocks:
    """Return by how much sensors are late: by what their readings were moved, and what is left in the state."""
    late, std = late_s.copy(), np.zeros(len(late_s))
    sought = of.clock_column != ABSENT
    at = of.clock_column[sought]
    late[sought] += x[at]
    std[sought] = np.sqrt(P[at, at])
    return Clocks(late, std)


def moved_back(course: Course, readings: Floats, late_s: Floats) -> Course:
    """Return a course whose readings are those of the instants that they are of, with their rates.

    Parameters
    ----------
    course : Course
    readings : (n, n_channel)
        As they were stamped.
    late_s : (n_sensor,) [s]
        By how much each sensor is late.
    """
    n = len(readings)
    t, there = course.dt * np.arange(n), course.present
    late = np.repeat(late_s, 3)
    moved = np.empty_like(readings)
    for channel, values in enumerate(readings.T):
        at = np.clip(t + late[channel], t[there][0], t[there][-1])
        moved[:, channel] = CubicSpline(t[there], values[there])(at) if np.any(late) else values
    filled = np.column_stack([np.interp(t, t[there], values[there]) for values in moved.T])
    window = max(_DEGREE + 1, round(_WINDOW_S / course.dt)) // 2 * 2 + 1
    if n < window:
        return course._replace(readings=moved, drift=np.zeros_like(readings))
    drift = savgol_filter(filled, window, _DEGREE, deriv=1, delta=course.dt, axis=0)
    return course._replace(readings=moved, drift=np.ascontiguousarray(drift))
