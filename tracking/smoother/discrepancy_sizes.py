"""Sizes of what the model lacks, as a pass of the smoother makes them likeliest: one step of the maximisation.

`tracking.model.discrepancy` says what they are sizes of. Each is the mean square that the smoother expects, its
own variance included.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.special import chdtri

from arm.model import Floats
from tracking.model.course import Course
from tracking.model.discrepancy import FREEDOM, Discrepancy
from tracking.model.observation import ABSENT, Observation, channels_alike
from tracking.smoother.smoothing_pass import Pass

#: Over how long noise is about as large [s]: a stroke and what it makes ring.
_WINDOW_S = 1.0
#: Steps of an estimate of scale; each gains a digit or two.
_STEPS = 15
#: Median of a squared normal number in units of its variance: that of chi squared with one degree of freedom.
_MEDIAN_OF_SQUARE = float(chdtri(1.0, 0.5))


def sizes_of(of: Observation, found: Pass, revolute: NDArray[np.bool_], memory_s: float) -> Discrepancy:
    """Return the sizes that the states of a pass and their variances make likeliest."""
    n = len(revolute)
    speeds = (found.states[:, 1 : 3 * n : 3] ** 2 + found.variance[:, 1 : 3 * n : 3]).mean(axis=0)
    speed_std = np.empty(n)
    for kind in (revolute, ~revolute):
        speed_std[kind] = np.sqrt(speeds[kind].mean()) if kind.any() else 0.0
    reported = {int(entry): place for place, entry in enumerate(of.reported)}

    def rms(first: int, count: int) -> float:
        if first == ABSENT:
            return 0.0
        squares = found.states[:, first : first + count] ** 2
        variance = found.variance[:, reported[first] : reported[first] + count]
        return float(np.sqrt((squares + variance).mean()))

    lacks = [0.0, 0.0]  # of accelerometers, of gyroscopes
    for k, part in enumerate(channels_alike(of) if of.lack_column != ABSENT else ()):
        lacks[k] = rms(of.lack_column + part.start, part.stop - part.start)
    return Discrepancy(lacks[0], rms(of.base_column, 3), memory_s, speed_std, lacks[1])


def noise_variances(of: Observation, course: Course, found: Pass) -> Floats:
    """Return the variance of each reading's noise, (n, n_channel), that of each kind of sensor by itself.

    That of its instant is the mean square over a second about it, as far as that says more than all instants, and
    each sensor's three readings at an instant count by Student's weight. None is less than the sensor's own noise.
    """
    return np.hstack([_alike_variances(course, found, part) for part in channels_alike(of)])


def _alike_variances(course: Course, found: Pass, part: slice) -> Floats:
    """Return the variance of the noise of some channels' readings, which measure the same, (n, n_part)."""
    n, n_channel = len(course.readings), part.stop - part.start
    before = course.noise[part] * course.doubt[:, part]
    residual, share = before * found.error[:, part], before * found.precision[:, part]
    squares = residual**2 / max(float(share[course.present].mean()), np.finfo(np.float64).tiny)
    squares[~course.present] = 0.0
    sensor = squares.reshape(n, -1, 3).sum(axis=2)
    there = course.present.astype(np.float64)
    overall = max(float(np.median(squares[course.present])) / _MEDIAN_OF_SQUARE, np.finfo(np.float64).tiny)
    for _ in range(_STEPS):
        overall = float((_weight(sensor, overall) * sensor)[course.present].mean()) / 3.0
    window = max(1, round(_WINDOW_S / course.dt))
    count = n_channel * window * uniform_filter1d(there, window, mode="nearest")
    local = np.full(n, overall)
    for _ in range(_STEPS):
        weighed = (_weight(sensor, local[:, None]) * sensor).mean(axis=1) / 3.0
        total = n_channel * window * uniform_filter1d(weighed, window, mode="nearest")
        local = (FREEDOM * overall + total) / (FREEDOM + count)
    variance = np.repeat(local[:, None] / _weight(sensor, local[:, None]), 3, axis=1)
    least: Floats = np.maximum(variance, course.noise[part])
    return least


def _weight(sensor: Floats, variance: Floats | float) -> Floats:
    """Return Student's weight of three readings whose squares have this sum."""
    return np.asarray((FREEDOM + 3.0) / (FREEDOM + sensor / variance))
