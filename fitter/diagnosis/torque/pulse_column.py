"""A pulse of size one as rows see it: behind their low-pass filter, as means over each row's samples."""

from functools import cache
from typing import NamedTuple

import numpy as np

from arm.model import Floats
from fitter.data.derivatives import lowpass, settling_samples
from fitter.diagnosis.torque.background import Rows
from limbcal.compiled import compiled

FORMS = ("rectangular", "bell")


def pulse_means(t: Floats, step_s: float, start_s: float, duration_s: float, form: str) -> Floats:
    """Return the means of a pulse of size one over the steps about evenly spaced instants, (n,)."""
    ends = np.append(t - 0.5 * step_s, t[-1:] + 0.5 * step_s)
    return np.asarray(np.diff(pulse_area(ends, start_s, duration_s, form)) / step_s)


def pulse_area(until: Floats, start_s: float, duration_s: float, form: str) -> Floats:
    """Return the area of a pulse of size one until each instant [s], of the instants' shape."""
    return _areas(np.ravel(until), start_s, duration_s, _is_bell(form)).reshape(np.shape(until))


class RowGrid(NamedTuple):
    """How rows come from samples, as compiled code takes it.

    Attributes
    ----------
    begin_s, step_s : float [s]
        Of the first row's instant, and between rows.
    n, n_sample : int
        Rows, and samples a row.
    response : (m,)
        The filter's to one sample of one, as a mean over a row; symmetric.
    settling_s : float [s]
        How far from a row its filter reaches.
    """

    begin_s: float
    step_s: float
    n: int
    n_sample: int
    response: Floats
    settling_s: float

    @classmethod
    def of(cls, rows: Rows) -> "RowGrid":
        """Return that of some rows."""
        row_s, n_sample = rows.step_s, rows.n_sample
        step_s = row_s / n_sample
        settling_s = step_s * settling_samples(step_s, rows.band_hz) + row_s  # a row is a mean
        response = _row_response(step_s, rows.band_hz, n_sample)
        return cls(float(rows.t[0]), row_s, len(rows.t), n_sample, response, settling_s)


def seen(
    rows: Rows, start_s: float, duration_s: float, form: str, reach_s: float | None = None
) -> tuple[int, Floats]:
    """Return a pulse of size one in the rows that it touches.

    The filter reaches for ``reach_s``; until it has settled if None.

    Returns
    -------
    first : int
        The first row that it touches.
    column : (m,)
        From there on, as long again as it lasts after its end: what follows from it in the background.
    """
    grid = RowGrid.of(rows)
    reach_s = grid.settling_s if reach_s is None else reach_s
    first, column = column_of(grid, reach_s, start_s, duration_s, _is_bell(form))
    return int(first), np.asarray(column)


def in_rows(rows: Rows, start_s: float, duration_s: float, form: str) -> Floats:
    """Return a pulse of size one in all rows, (n,)."""
    column = np.zeros(len(rows.t))
    first, part = seen(rows, start_s, duration_s, form)
    column[first : first + len(part)] = part
    return column


def _is_bell(form: str) -> bool:
    return form == "bell"


@cache
def _row_response(step_s: float, band_hz: float, n_sample: int) -> Floats:
    """Return the response of the means of as many samples to one sample of one behind the low-pass filter."""
    reach = 2 * settling_samples(step_s, band_hz)
    one = np.zeros(4 * reach + 1)
    one[2 * reach] = 1.0
    sampled = lowpass(one, step_s, band_hz)[reach : 3 * reach + 1]
    return np.asarray(np.convolve(sampled, np.full(n_sample, 1.0 / n_sample)))


@compiled
def column_of(grid: RowGrid, reach_s: float, start_s: float, duration_s: float, bell: bool) -> tuple[int, Floats]:
    """Return `seen` of a pulse, bell-shaped or rectangular, whose filter reaches for ``reach_s``."""
    beyond_s = 0.5 * duration_s if bell else 0.0
    from_s, until_s = start_s - beyond_s, start_s + duration_s + beyond_s
    begin, end = (from_s - reach_s - grid.begin_s), (until_s + duration_s + reach_s - grid.begin_s)
    first = min(max(int(np.ceil(begin / grid.step_s)), 0), grid.n)
    last = min(max(int(np.ceil(end / grid.step_s)), first), grid.n)
    column = np.zeros(last - first)
    step_s = grid.step_s / grid.n_sample
    origin_s = grid.begin_s - 0.5 * grid.step_s  # where the samples of the first row begin
    low, high = int(np.floor((from_s - origin_s) / step_s)), int(np.ceil((until_s - origin_s) / step_s))
    # Only the samples of the rows that it touches count.
    low, high = max(low, first * grid.n_sample), min(high, last * grid.n_sample)
    if high <= low:
        return first, column
    ends: Floats = origin_s + step_s * np.arange(low, high + 1).astype(np.float64)
    areas = _areas(ends, start_s, duration_s, bell)
    middle = (len(grid.response) + grid.n_sample - 1) // 2
    for row in range(last - first):
        at = (first + row) * grid.n_sample - low + middle
        for i in range(max(0, at - len(grid.response) + 1), min(high - low, at + 1)):
            column[row] += (areas[i + 1] - areas[i]) / step_s * grid.response[at - i]
    return first, column


@compiled
def _areas(until: Floats, start_s: float, duration_s: float, bell: bool) -> Floats:
    """Return the area of a pulse of size one until each instant, (n,) [s]."""
    area = np.empty(len(until))
    for i in range(len(until)):
        if bell:
            u = min(max((until[i] - start_s) / (2.0 * duration_s) + 0.25, 0.0), 1.0)
            area[i] = duration_s * (u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi))
        else:
            area[i] = min(max(until[i] - start_s, 0.0), duration_s)
    return area
