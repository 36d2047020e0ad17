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
from tracking.dead_reckoning.rest_cell import WINDOW, RestWindow, judge_cell, learn_offset, look_at

#: How many steps more two sensors may disagree where gravity shows: they round it anew in every pose.
_ROUNDING_STEPS = 1.0


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
            self._found_step = look_at(cell, gravity, self._found_step, excess)
            self._variances.append(float(np.mean(np.diff(cell, axis=0) ** 2) / 2.0))
            self._sigma = float(np.sqrt(np.mean(self._variances) / len(cell)))
            self._learn(excess)
            return True
        self.resting, self._creeping, self.jolted, self._found_step, self._n_cells = judge_cell(
            self.window, cell, gravity, excess
        )
        if self.resting and not pinned:
            self._learn(excess)
        return self.resting

    @property
    def window(self) -> RestWindow:
        """What the next cell is judged by."""
        return RestWindow(
            self.resting,
            self._creeping,
            self._found_step,
            self._sigma,
            self._weight,
            self._n_cells,
            self._cells,
            self.offset,
            self._slack,
            self._contrast,
            self._rounded,
        )

    @property
    def settled(self) -> bool:
        """Whether the rest at the start has been learnt, which is taken on trust."""
        return self._weight >= WINDOW

    def go_on(self, window: RestWindow) -> None:
        """Go on from where a kernel has carried the window; in none of its cells a motion began or ended."""
        self.jolted, self._creeping, self._found_step = False, window.creeping, window.least
        self._weight, self._n_cells = window.weight, window.n_cells

    def forget(self) -> None:
        """Start a new window: samples were lost."""
        self._n_cells = 0

    def _learn(self, excess: Floats) -> None:
        self._weight = learn_offset(self.offset, self._weight, excess)
