"""Recognising from the readings alone that the arm rests, and what the sensors then read too much.

Readings are judged in cells of 10 ms and windows of a quarter of a second. At rest every sensor reads gravity
and its own offset, so a window's mean must not have moved away from them by more than noise can move it, and no
single cell may stand out. Where a joint's angle changes what gravity shows, the angle's own drift is allowed
for; the difference of two sensors on one link does not depend on gravity at all and is always judged strictly.

This is the integrator's detector: dead reckoning has no covariance, so it cannot ask as
`tracking.model.zero_velocity` does how well pose and velocity are known, and it must learn the sensors' offsets,
which a filter estimates anyway.
"""

import math

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
#: How many steps more two sensors may disagree where gravity shows: they round it anew in every pose.
_ROUNDING_STEPS = 1.0
#: Nobody's accelerometer is trusted beyond this [m/s^2].
_FINEST = 3e-5
#: Cells of rest that the offset remembers (4 s).
_MEMORY = 400
#: Weights of a window's cells that make its trend, which is about the second half less the first.
_TREND = (np.arange(WINDOW) - (WINDOW - 1) / 2) / ((WINDOW - 1) / 2 * WINDOW / 4)
_TREND_SPREAD = float(np.linalg.norm(_TREND))


class RestDetector:
    """Judges cell after cell whether the arm rests.

    Parameters
    ----------
    contrast : (n_contrast, n_channel)
        Combinations of readings that no rest can change, such as differences of two sensors on one link.
    gravity_slack : (n_channel,) [m/s^2]
        By how much drift of the angles may change what gravity shows in each channel.

    Attributes
    ----------
    resting : bool
        Begins as True: the arm rests when tracking begins.
    jolted : bool
        The arm all but rested, creeping, and in this cell was set in motion anew.
    offset : (n_channel,)
        Mean reading at rest minus what gravity alone would show.
    """

    def __init__(self, contrast: Floats, gravity_slack: Floats) -> None:
        self.resting = True
        self.offset = np.zeros(len(gravity_slack))
        self._contrast = np.ascontiguousarray(contrast)
        self._slack = gravity_slack
        self._rounded = np.where(np.abs(contrast) @ gravity_slack > 0.0, _ROUNDING_STEPS, 0.0)
        self._cells = np.zeros((WINDOW, len(gravity_slack)))  # the latest last
        self._n_cells = 0
        self._variances: list[float] = []
        self._sigma = 0.0
        self._found_step = math.inf
        self._weight = 0
        self.jolted = False
        self._creeping = False

    def judge(self, cell: Floats, gravity: Floats, pinned: bool) -> bool:
        """Take in a cell of readings and say whether the arm rests in it.

        Parameters
        ----------
        cell : (n, n_channel) [m/s^2]
        gravity : (n_channel,) [m/s^2]
            What the sensors would read of gravity alone, by the angles known.
        pinned : bool
            The offset is not to be learnt from later rests, only from the first.

        Returns
        -------
        bool
        """
        excess = np.empty(len(self._slack))
        if self._weight < WINDOW:  # the rest at the start is taken on trust: nothing to compare it with yet
            self._found_step = _look(cell, gravity, self._found_step, excess)
            self._variances.append(float(np.mean(np.diff(cell, axis=0) ** 2) / 2.0))
            self._sigma = float(np.sqrt(np.mean(self._variances) / len(cell)))
            self._learn(excess)
            return True
        self._found_step, smooth, jumped, unrest = _compare(
            cell,
            gravity,
            self._found_step,
            self._sigma,
            self.offset,
            self._weight,
            self._cells,
            self._n_cells,
            self._slack,
            self._contrast,
            self._rounded,
            excess,
        )
        self.jolted = self._creeping and not self.resting and not smooth and jumped
        self._n_cells = min(self._n_cells + 1, WINDOW) if smooth else 0
        self._creeping = unrest <= _TO_LEAVE
        if self.resting:
            self.resting = smooth and (unrest <= _TO_LEAVE or self._n_cells < WINDOW)
        else:
            self.resting = unrest <= 1.0
        if self.resting and not pinned:
            self._learn(excess)
        return self.resting

    def forget(self) -> None:
        """Start a new window: samples were lost."""
        self._n_cells = 0

    def _learn(self, excess: Floats) -> None:
        self._weight = min(self._weight + 1, _MEMORY)
        self.offset += (excess - self.offset) / self._weight


@compiled
def _look(cell: Floats, gravity: Floats, least: float, excess: Floats) -> float:
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
    least = _look(cell, gravity, least, excess)
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
