"""Sensors whose clocks differ: each reading is of a little earlier or later than its stamp says.

A sensor that is late by c reads h(t - c) at t. Its readings are moved back by what is known of c; what is left of
it is a constant of the state, whose slope is -dh/dt (as where cameras are calibrated with inertial sensors;
P. Furgale, J. Rehder, R. Siegwart, *Unified temporal and spatial calibration for multi-sensor systems*, 2013).
Only differences show: the first sensor's clock is the one that counts.
"""

from typing import NamedTuple

import numpy as np
import scipy

from arm.model import Floats
from tracking.model.course import Course
from tracking.model.observation import ABSENT, Observation

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


class ClockSearch:
    """Seeks by how much sensors are late, of a recording whose readings are moved back from pass to pass.

    Parameters
    ----------
    of : Observation
        One without clocks seeks nothing.
    readings : (n, n_channel)
        As they were stamped.
    """

    def __init__(self, of: Observation, readings: Floats) -> None:
        self._sought = of.clock_column != ABSENT
        self._columns = of.clock_column[self._sought]
        self._stamped, self.late_s = readings, np.zeros(of.link.size)

    def begin(self, x: Floats, P: Floats) -> None:
        """Put what is held of the clocks before the first reading into a state and its covariance."""
        at = self._columns
        x[at] = 0.0
        P[at], P[:, at] = 0.0, 0.0
        P[at, at] = CLOCK_STD_S**2

    def moved(self, course: Course) -> Course:
        """Return the course with its readings moved back by what is known; as it is if nothing is sought."""
        return moved_back(course, self._stamped, self.late_s) if self._columns.size else course

    def take(self, x: Floats, P: Floats, x0: Floats, at: Floats) -> bool:
        """Take over what a pass found, and say whether readings are to be moved anew.

        Parameters
        ----------
        x, P : (n_state,), (n_state, n_state)
            After the last reading.
        x0, at : (n_state,), (n, n_state)
            Before the first reading, and along which readings are linearised: less by what is taken over.
        """
        left = x[self._columns].copy()
        if not np.any(np.abs(left) > CLOCK_STEP * self._std(P)):
            return False
        self.late_s[self._sought] += left
        x0[self._columns] -= left
        at[:, self._columns] -= left
        return True

    def _std(self, P: Floats) -> Floats:
        """Return how well the clocks are known; a pass that is far off may lose all digits of a covariance."""
        std: Floats = np.sqrt(np.maximum(P[self._columns, self._columns], 0.0))
        return std

    def found(self, x: Floats, P: Floats) -> Clocks | None:
        """Return by how much sensors are late: by what readings were moved, and what is left in the state."""
        if not self._columns.size:
            return None
        late, std = self.late_s.copy(), np.zeros(len(self.late_s))
        late[self._sought] += x[self._columns]
        std[self._sought] = self._std(P)
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
    moved = np.empty(readings.shape)
    for channel, values in enumerate(readings.T):
        at = np.clip(t + late[channel], t[there][0], t[there][-1])
        moved[:, channel] = scipy.interpolate.CubicSpline(t[there], values[there])(at) if np.any(late) else values
    filled = np.column_stack([np.interp(t, t[there], values[there]) for values in moved.T])
    window = max(_DEGREE + 1, round(_WINDOW_S / course.dt)) // 2 * 2 + 1
    if n < window:
        return course._replace(readings=moved, drift=np.zeros_like(readings))
    drift = scipy.signal.savgol_filter(filled, window, _DEGREE, deriv=1, delta=course.dt, axis=0)
    return course._replace(readings=moved, drift=np.ascontiguousarray(drift))
