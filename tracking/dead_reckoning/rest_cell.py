"""A cell of readings, judged whether the arm rests in it: compiled.

See `tracking.dead_reckoning.rest`, which says what a rest is.
"""

import math
from typing import NamedTuple

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Cells a window; a quarter of a second at 10 ms.
WINDOW = 25
#: Standard deviations that a mean may be off: of a cell, by chance once in 5e8, and of a window, once in 16 000.
_CELL_SIGMAS, _WINDOW_SIGMAS = 6.0, 4.0
#: How much further a window must stray to end a rest than to begin one, so that creeping does not flutter.
_TO_LEAVE = 4.0
#: The sizes below were chosen by hand on the bench's seeds 0 to 5, not derived; judge them on other seeds.
#: Where there is no noise the converter's resolution limits: how many of its steps a mean may be off.
_CELL_STEPS, _WINDOW_STEPS = 7.0, 0.5
#: Nobody's accelerometer is trusted beyond this [m/s^2].
_FINEST = 3e-5
#: Cells of rest that the offset remembers (4 s).
_MEMORY = 400
#: Weights of a window's cells that make its trend, which is about the second half less the first.
_TREND = (np.arange(WINDOW) - (WINDOW - 1) / 2) / ((WINDOW - 1) / 2 * WINDOW / 4)
_TREND_SPREAD = float(np.linalg.norm(_TREND))


class RestWindow(NamedTuple):
    """What a kernel judges cells by, see `RestDetector`; ``cells`` and ``offset`` are carried on in place.

    Attributes
    ----------
    resting, creeping : bool
    least : float
        By how much two readings in a row differed at the least [m/s^2].
    sigma : float
        Standard deviation of a cell's mean [m/s^2].
    weight, n_cells : int
        Cells that the offset remembers, and of rest in a row, none beyond the window.
    cells : (WINDOW, n_channel) [m/s^2]
        The latest last.
    offset, slack : (n_channel,) [m/s^2]
    contrast : (n_contrast, n_channel)
    rounded : (n_contrast,)
    """

    resting: bool
    creeping: bool
    least: float
    sigma: float
    weight: int
    n_cells: int
    cells: Floats
    offset: Floats
    slack: Floats
    contrast: Floats
    rounded: Floats


@compiled
def judge_cell(
    window: RestWindow, cell: Floats, gravity: Floats, excess: Floats
) -> tuple[bool, bool, bool, float, int]:
    """Take in a cell of readings (n, n_channel) and fill in by how much its mean exceeds gravity, (n_channel,).

    Returns
    -------
    resting, creeping, jolted : bool
    least : float
    n_cells : int
        Of the window after it.
    """
    least, smooth, jumped, unrest = _compare(
        cell,
        gravity,
        window.least,
        window.sigma,
        window.offset,
        window.weight,
        window.cells,
        window.n_cells,
        window.slack,
        window.contrast,
        window.rounded,
        excess,
    )
    n_cells = min(window.n_cells + 1, WINDOW) if smooth else 0
    if window.resting:
        resting = smooth and (unrest <= _TO_LEAVE or n_cells < WINDOW)
    else:
        resting = unrest <= 1.0
    jolted = window.creeping and not window.resting and not smooth and jumped
    return resting, unrest <= _TO_LEAVE, jolted, least, n_cells


@compiled
def learn_offset(offset: Floats, weight: int, excess: Floats) -> int:
    """Take a resting cell's excess (n_channel,) into the offset; return how many cells that remembers."""
    weight = min(weight + 1, _MEMORY)
    for c in range(offset.size):
        offset[c] += (excess[c] - offset[c]) / weight
    return weight


@compiled
def look_at(cell: Floats, gravity: Floats, least: float, excess: Floats) -> float:
    """Fill in by how much a cell's mean exceeds gravity; return the least by which two readings in a row differed.

    That, or ``least`` where it is less, is how the converter's resolution is learnt.
    """
    excess[:] = 0.0
    for k in range(cell.shape[0]):
        for c in range(excess.size):
            excess[c] += cell[k, c]
            if k > 0:
                change = abs(cell[k, c] - cell[k - 1, c])
                if 0.0 < change < least:
                    least = change
    for c in range(excess.size):
        excess[c] = excess[c] / cell.shape[0] - gravity[c]
    return least


@compiled
def _compare(
    cell: Floats,
    gravity: Floats,
    least: float,
    sigma: float,
    offset: Floats,
    weight: int,
    cells: Floats,
    n_cells: int,
    slack: Floats,
    contrast: Floats,
    rounded: Floats,
    excess: Floats,
) -> tuple[float, bool, bool, float]:
    """Fill in by how much a cell exceeds gravity, and hold it against the offset and the cells before it.

    Returns the least by which readings differed, whether the cell may be one of rest, whether it is far from the
    cell before, and how far the window strays, as a share of what a rest may; infinite until the window is full.
    A cell that may be one of rest is added to ``cells``, of which the last ``n_cells`` count.
    """
    least = look_at(cell, gravity, least, excess)
    step = max(_FINEST, least) if least < math.inf else _FINEST
    limit = _CELL_SIGMAS * sigma + _CELL_STEPS * step
    stray = excess - offset
    smooth = _share(stray, limit, step, slack, contrast, rounded) <= 1.0
    jumped = n_cells > 0 and _furthest(excess, cells[WINDOW - 1]) > limit
    if not smooth:
        return least, smooth, jumped, math.inf
    cells[:-1] = cells[1:]
    cells[WINDOW - 1] = excess
    if n_cells + 1 < WINDOW:
        return least, smooth, jumped, math.inf
    # A motion's acceleration also passes through zero: then the window's mean is small, its trend is not.
    trend = np.empty(offset.size)
    _strays(cells, offset, stray, trend)
    unrest = -math.inf
    for strays, spread in ((stray, math.sqrt(1.0 / WINDOW + 1.0 / weight)), (trend, _TREND_SPREAD)):
        most = _WINDOW_SIGMAS * sigma * spread + _WINDOW_STEPS * step
        unrest = max(unrest, _share(strays, most, step, slack, contrast, rounded))
    return least, smooth, jumped, unrest


@compiled
def _strays(cells: Floats, offset: Floats, mean: Floats, trend: Floats) -> None:
    """Fill in how far a window's mean and its trend stray."""
    mean[:] = 0.0
    trend[:] = 0.0
    for k in range(cells.shape[0]):
        for c in range(offset.size):
            mean[c] += cells[k, c]
            trend[c] += _TREND[k] * cells[k, c]
    for c in range(offset.size):
        mean[c] = mean[c] / cells.shape[0] - offset[c]


@compiled
def _share(mean: Floats, limit: float, step: float, slack: Floats, contrast: Floats, rounded: Floats) -> float:
    """Return the largest reading, beyond what gravity may do to it, as a share of its limit."""
    worst = -math.inf
    for c in range(mean.size):
        worst = max(worst, (abs(mean[c]) - slack[c]) / limit)
    for row in range(contrast.shape[0]):
        total = 0.0
        for c in range(mean.size):
            total += contrast[row, c] * mean[c]
        worst = max(worst, abs(total) / (math.sqrt(2.0) * (limit + rounded[row] * step)))
    return worst


@compiled
def _furthest(one: Floats, other: Floats) -> float:
    furthest = 0.0
    for c in range(one.size):
        furthest = max(furthest, abs(one[c] - other[c]))
    return furthest
