"""The filter of the arm as its file has it, for as long as readings fit; otherwise of an arm like it."""

from collections import deque
from dataclasses import replace

import numpy as np

from arm.model import Arm, Floats
from tracking.kalman.batch_filter import Course, joined
from tracking.kalman.discrepancy_filter import DiscrepancyFilter
from tracking.kalman.model_bank import LONG_S
from tracking.kalman.multiple_model_filter import MultipleModelFilter
from tracking.model.innovation_test import Consistency
from tracking.model.noise import Noise

#: In how long it is next asked whether readings fit [s], and for what multiple of it one looks back: a joint
#: that sets out strains a filter for some hundredths of a second. Another one begins anew as long before.
_SPAN_S, _BACK = 0.5, 4
#: Readings contradict the arm if the innovations' mean square is this many times what the filter claims, a
#: convention: as much again as it knows of.
_CONTRADICTED = 2.0


class AdaptiveFilter:
    """A live filter that takes in many readings, and goes on where they contradict its arm.

    The filter of the exact arm always goes on. Where its innovations are much larger than it claims, another one,
    which learns what its model lacks, begins anew some time before. It is believed until the first has been right
    for as long as evidence is remembered; that one begins anew from the other whenever it is wrong.

    Parameters are those of `tracking.kalman.live_filter.LiveFilter`.
    """

    def __init__(
        self, arm: Arm, q: Floats, given: bool, first: Floats, noise: Noise, factor: int, dt_s: float
    ) -> None:
        self._arm, self._noise, self._factor, self._dt = arm, noise, factor, dt_s
        self._exact = MultipleModelFilter(arm, q, given, first, noise, factor, dt_s)
        self._lacking: DiscrepancyFilter | None = None
        self._span, self._in_span, self._right_s = max(1, round(_SPAN_S / dt_s)), 0, 0.0
        self._strains: deque[float] = deque(maxlen=_BACK)
        self._marks = deque([self._exact.state], maxlen=_BACK)
        self._since: deque[list[Floats]] = deque([[]], maxlen=_BACK)
        self._lacked = (0.0, 0.0)

    def follow(self, readings: Floats) -> Course:
        """Take in readings, (n, n_channel), and say what came of each; those of a lost frame are NaN."""
        parts = []
        while len(readings):
            end = self._span - self._in_span
            part, readings = readings[:end], readings[end:]
            course = self._exact.follow(part)
            if self._lacking is not None:
                course = self._lacking.follow(part)
                lack, base = self._lacking.sizes
                self._lacked = max(self._lacked[0], lack), max(self._lacked[1], base)
            parts.append(course)
            self._since[-1].append(part)
            self._in_span += len(part)
            if self._in_span == self._span:
                self._judge()
        return joined(parts)

    def _judge(self) -> None:
        """Ask which filter is to be believed."""
        self._in_span = 0
        self._strains.append(self._exact.strain())
        right = np.mean(self._strains) < _CONTRADICTED
        self._right_s = self._right_s + self._span * self._dt if right else 0.0
        if self._lacking is None and not right:
            self._lacking = DiscrepancyFilter(self._arm, *self._marks[0], self._noise, self._factor, self._dt)
            for part in self._since:
                self._lacking.follow(np.concatenate(part))
        if self._lacking is not None:
            if not right:
                self._exact.begin_anew(*self._lacking.state)
                self._strains.clear()
            elif self._right_s > LONG_S:
                self._lacking = None
        self._marks.append(self._exact.state)
        self._since.append([])

    def skip(self, frames: int) -> None:
        """Let lost frames go by that nobody asks for."""
        self._exact.skip(frames)
        if self._lacking is not None:
            self._lacking.skip(frames)

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        self._dt = dt_s
        for one in (self._exact, self._lacking):
            if one is not None:
                one.retime(dt_s)

    def learn(self, noise: Noise) -> None:
        """Go on with what is now known of the noise of a sample."""
        self._noise = noise
        for one in (self._exact, self._lacking):
            if one is not None:
                one.learn(noise)

    def consistency(self) -> Consistency:
        """Return how well the readings since the last call fit the arm, and what its model lacks of them."""
        said, lacked = self._exact.consistency(), self._lacked
        self._lacked = (0.0, 0.0)
        if self._lacking is None and not any(lacked):
            return said
        return replace(said, wrong=True, discrepancy_m_s2=lacked[0], base_m_s2=lacked[1])
