"""Recognising from the readings alone that the arm rests, and what the sensors then read too much.

Readings are judged in cells of 10 ms and windows of a quarter of a second. At rest every sensor reads gravity
and its own offset, so a window's mean must not have moved away from them by more than noise can move it, and no
single cell may stand out. Where a joint's angle changes what gravity shows, the angle's own drift is allowed
for; the difference of two sensors on one link does not depend on gravity at all and is always judged strictly.
"""

import math

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Cells a window; a quarter of a second at 10 ms.
WINDOW = 25
#: How many standard deviations a mean may be off: cell, window.
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
        self._step = _FINEST
        self._found_step = math.inf
        self._weight = 0
        self.jolted = False
        self._creeping = False
        middle = (WINDOW - 1) / 2
        # About the second half less the first.
        self._trend = (np.arange(WINDOW, dtype=np.float64) - middle) / (middle * WINDOW / 4)
        self._trend_spread = float(np.linalg.norm(self._trend))

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
        self._found_step = _look(cell, gravity, self._found_step, excess)
        self._step = max(_FINEST, self._found_step) if self._found_step < math.inf else _FINEST
        if self._weight < WINDOW:  # the rest at the start is taken on trust: nothing to compare it with yet
            self._variances.append(float(np.mean(np.diff(cell, axis=0) ** 2) / 2.0))
            self._sigma = float(np.sqrt(np.mean(self._variances) / len(cell)))
            self._learn(excess)
            return True
        limit = _CELL_SIGMAS * self._sigma + _CELL_STEPS * self._step
        smooth = self._share(excess - self.offset, limit) <= 1.0
        jump = _furthest(excess, self._cells[-1]) if self._n_cells else 0.0
        self.jolted = self._creeping and not self.resting and not smooth and jump > limit
        if smooth:
            self._cells[:-1] = self._cells[1:]
            self._cells[-1] = excess
            self._n_cells = min(self._n_cells + 1, WINDOW)
        else:
            self._n_cells = 0
        unrest = self._unrest()
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

    def _unrest(self) -> float:
        """Return how far the window strays, as a share of what a rest may; infinite until the window is full."""
        if self._n_cells < WINDOW:
            return math.inf
        # A motion's acceleration also passes through zero: then the window's mean is small, its trend is not.
        strays = np.empty((2, len(self._slack)))
        _strays(self._cells, self.offset, self._trend, strays)
        spreads = math.sqrt(1.0 / WINDOW + 1.0 / self._weight), self._trend_spread
        return max(
            self._share(stray, _WINDOW_SIGMAS * self._sigma * spread + _WINDOW_STEPS * self._step)
            for stray, spread in zip(strays, spreads, strict=True)
        )

    def _share(self, mean: Floats, limit: float) -> float:
        """Return the largest reading, beyond what gravity may do to it, as a share of its limit."""
        return _share(mean, limit, self._step, self._slack, self._contrast, self._rounded)

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
def _strays(cells: Floats, offset: Floats, trend: Floats, strays: Floats) -> None:
    """Fill in how far a window's mean and its trend stray, (2, n_channel)."""
    strays[:] = 0.0
    for k in range(cells.shape[0]):
        for c in range(offset.size):
            strays[0, c] += cells[k, c]
            strays[1, c] += trend[k] * cells[k, c]
    for c in range(offset.size):
        strays[0, c] = strays[0, c] / cells.shape[0] - offset[c]


@compiled
def _share(mean: Floats, limit: float, step: float, slack: Floats, contrast: Floats, rounded: Floats) -> float:
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
