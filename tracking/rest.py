"""Recognising from the readings alone that the arm rests, and what the sensors then read too much.

Readings are judged in cells of 10 ms and windows of a quarter of a second. At rest every sensor reads gravity
and its own offset, so a window's mean must not have moved away from them by more than noise can move it, and no
single cell may stand out. Where a joint's angle changes what gravity shows, the angle's own drift is allowed
for; the difference of two sensors on one link does not depend on gravity at all and is always judged strictly.
"""

from collections import deque

import numpy as np

from arm.model import Floats

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
        self._contrast = contrast
        self._slack = gravity_slack
        self._rounded = _ROUNDING_STEPS * (np.abs(contrast) @ gravity_slack > 0.0)
        self._cells: deque[Floats] = deque(maxlen=WINDOW)
        self._variances: list[float] = []
        self._sigma = 0.0
        self._step = _FINEST
        self._found_step = np.inf
        self._weight = 0
        self.jolted = False
        self._creeping = False
        middle = (WINDOW - 1) / 2
        self._trend = (np.arange(WINDOW) - middle) / (middle * WINDOW / 4)  # about the second half less the first

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
        excess = cell.mean(axis=0) - gravity
        self._measure_step(cell)
        if self._weight < WINDOW:  # the rest at the start is taken on trust: nothing to compare it with yet
            self._variances.append(float(np.mean(np.diff(cell, axis=0) ** 2) / 2.0))
            self._sigma = float(np.sqrt(np.mean(self._variances) / len(cell)))
            self._learn(excess)
            return True
        limit = _CELL_SIGMAS * self._sigma + _CELL_STEPS * self._step
        smooth = self._calm(excess - self.offset, limit)
        jump = float(np.max(np.abs(excess - self._cells[-1]))) if self._cells else 0.0
        self.jolted = self._creeping and not self.resting and not smooth and jump > limit
        if smooth:
            self._cells.append(excess)
        else:
            self._cells.clear()
        unrest = self._unrest()
        self._creeping = unrest <= _TO_LEAVE
        if self.resting:
            self.resting = smooth and (unrest <= _TO_LEAVE or len(self._cells) < WINDOW)
        else:
            self.resting = unrest <= 1.0
        if self.resting and not pinned:
            self._learn(excess)
        return self.resting

    def forget(self) -> None:
        """Start a new window: samples were lost."""
        self._cells.clear()

    def _unrest(self) -> float:
        """Return how far the window strays, as a share of what a rest may; infinite until the window is full."""
        if len(self._cells) < WINDOW:
            return np.inf
        cells = np.array(self._cells, dtype=np.float64)
        # A motion's acceleration also passes through zero: then the window's mean is small, its trend is not.
        strays = cells.sum(axis=0) / WINDOW - self.offset, self._trend @ cells
        spreads = np.sqrt(1.0 / WINDOW + 1.0 / self._weight), float(np.linalg.norm(self._trend))
        return max(
            self._share(stray, _WINDOW_SIGMAS * self._sigma * spread + _WINDOW_STEPS * self._step)
            for stray, spread in zip(strays, spreads, strict=True)
        )

    def _calm(self, mean: Floats, limit: float) -> bool:
        return self._share(mean, limit) <= 1.0

    def _share(self, mean: Floats, limit: float) -> float:
        """Return the largest reading, beyond what gravity may do to it, as a share of its limit."""
        strict = np.abs(self._contrast @ mean) / (np.sqrt(2.0) * (limit + self._rounded * self._step))
        return float(max(np.max((np.abs(mean) - self._slack) / limit), np.max(strict, initial=0.0)))

    def _measure_step(self, cell: Floats) -> None:
        """Learn the converter's resolution: the least by which two readings in a row ever differed."""
        change = np.abs(np.diff(cell, axis=0))
        change = change[change > 0.0]
        if change.size:
            self._found_step = min(self._found_step, float(change.min()))
            self._step = max(_FINEST, self._found_step)

    def _learn(self, excess: Floats) -> None:
        self._weight = min(self._weight + 1, _MEMORY)
        self.offset += (excess - self.offset) / self._weight
