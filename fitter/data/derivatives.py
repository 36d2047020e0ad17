"""Zero-phase low-pass filtering and differentiation on a uniform grid."""

import functools
import math
from collections.abc import Callable
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from limbcal.compiled import compiled

Floats = NDArray[np.float64]
Ends = Literal["odd", "even"]

#: Order of the Butterworth filter; there and back it falls by 6 dB at its corner, then by 48 dB an octave.
ORDER = 4
#: Periods of the corner frequency after which the guess about what lies beyond an end has died away.
SETTLING_PERIODS = 2.0
#: This multiple of it is guessed, so that even a column that does not end at rest begins settled.
PADDING = 3
#: A corner above this share of the sampling rate leaves nothing to filter.
HIGHEST_CORNER = 0.45


def lowpass(values: Floats, dt_s: float, cutoff_hz: float, ends: Ends = "odd") -> Floats:
    """Low-pass columns without any phase shift.

    A Butterworth filter of order 4 runs forwards and backwards (gain 1/2 at the corner, 1 at rest). What lies
    beyond the ends of a column is guessed; `settling_samples` at each end are touched by that.

    Parameters
    ----------
    values : ndarray of shape (n, …)
        Columns along the first axis.
    dt_s : float
        Step [s].
    cutoff_hz : float
        Corner frequency. Above 0.45 of the sampling rate nothing is changed.
    ends : {"odd", "even"}
        Beyond an end a column is thought to go on turned about its last point, which keeps up a slope, or
        mirrored, which does not lean on one noisy sample.

    Returns
    -------
    ndarray of the same shape
    """
    if cutoff_hz * dt_s >= HIGHEST_CORNER:
        return values
    padding = min(len(values) - 1, PADDING * settling_samples(dt_s, cutoff_hz))
    before, after = values[padding:0:-1], values[-2 : -padding - 2 : -1]
    if ends == "odd":
        before, after = 2.0 * values[0] - before, 2.0 * values[-1] - after
    column = np.concatenate([before, values, after])
    passed = there_and_back(*_sections(dt_s, cutoff_hz), np.ascontiguousarray(column.reshape(len(column), -1)))
    return np.asarray(passed[padding : padding + len(values)].reshape(values.shape))


@compiled
def there_and_back(sections: Floats, settled: Floats, columns: Floats) -> Floats:
    """Return columns (n, m) behind a filter's sections, run forwards and what came of that backwards.

    `scipy.signal.sosfilt` does the same, but its checks take longer than a short column.
    """
    n, m = columns.shape
    passed, state = columns.copy(), np.zeros_like(settled)
    for j in range(m):
        for way in (1, -1):
            k = 0 if way > 0 else n - 1
            state[:] = settled * passed[k, j]
            for _ in range(n):
                x = passed[k, j]
                for i in range(len(sections)):
                    b0, b1, b2, _one, a1, a2 = sections[i]
                    y = b0 * x + state[i, 0]
                    state[i, 0] = b1 * x - a1 * y + state[i, 1]
                    state[i, 1] = b2 * x - a2 * y
                    x = y
                passed[k, j] = x
                k += way
    return passed


@functools.cache
def _sections(dt_s: float, cutoff_hz: float) -> tuple[Floats, Floats]:
    """Return the filter's sections and their state when settled at one, made once: `sosfiltfilt` makes it anew."""
    sections = np.asarray(scipy.signal.butter(ORDER, cutoff_hz, fs=1.0 / dt_s, output="sos"), dtype=np.float64)
    return sections, np.asarray(scipy.signal.sosfilt_zi(sections), dtype=np.float64)


def settling_samples(dt_s: float, cutoff_hz: float) -> int:
    """Return how many samples at each end of a filtered column rest on a guess about what lies beyond."""
    if cutoff_hz * dt_s >= HIGHEST_CORNER:
        return 0
    return math.ceil(SETTLING_PERIODS / (cutoff_hz * dt_s)) + ORDER


def differentiate(values: Floats, dt_s: float, order: int = 1) -> Floats:
    """Return a time derivative of columns: that of the quintic spline through them.

    It is symmetric in time, so it shifts no phase; its error falls with the fourth power of the step or faster.

    Parameters
    ----------
    values : ndarray of shape (n, …), n >= 6
        Columns along the first axis.
    dt_s : float
        Step [s].
    order : {1, 2}
        First or second derivative.

    Returns
    -------
    ndarray of the same shape
    """
    return _along(_spline(values), len(values), dt_s, order)


def both_derivatives(values: Floats, dt_s: float) -> tuple[Floats, Floats]:
    """Return the first and the second derivative of columns, as `differentiate` does, by one spline."""
    spline = _spline(values)
    return _along(spline, len(values), dt_s, 1), _along(spline, len(values), dt_s, 2)


def _spline(values: Floats) -> Callable[..., Floats]:
    return scipy.interpolate.make_interp_spline(np.arange(len(values)), values, k=5, axis=0)


def _along(spline: Callable[..., Floats], n: int, dt_s: float, order: int) -> Floats:
    derivative: Floats = spline(np.arange(n), nu=order) / dt_s**order
    return derivative
