"""How many ticks of the device's clock a sample takes, measured from the frames themselves.

Between two frames that follow each other by number, with n samples in the first, the clock goes on by

    s = n p + e,

p ticks a sample, e the rounding to whole ticks and the jitter of the clock's reading. From the first mark to the
last, S ticks and N samples further, p = S / N, off by at most one tick in S. A step that fits no such p is a loss;
but if most steps fit another p than the device's INFO says, INFO is wrong, and nothing is lost. So before p is
measured nothing follows from a step that contradicts INFO: the sum of the next ones near their median decides,
in which the rounding of each cancels that of the next.
"""

import math
from collections import deque
from collections.abc import Sequence
from statistics import median, median_low

#: Number of steps that make a majority, even with two losses among them.
MAJORITY = 5
#: A measured p is that of the last ten seconds, from marks a quarter of a second apart.
_MARK_S, _MARKS = 0.25, 40
#: After a loss the p that was measured before it holds until as much was seen again, or this [s].
_ENOUGH_S = 1.0
#: Fewer ticks than these do not tell p to a part in a thousand.
_FEW_TICKS = 1000
#: Rounding a reading at either end of a step moves it by up to a tick; half a sample is nobody's.
_ROUNDING_TICKS, _HALF = 1.5, 0.5
#: Standard deviation of a normal distribution by its median absolute deviation: 1 / Phi^-1(3/4).
MAD_TO_STD = 1.4826
#: Jitter of a step in median absolute deviations: five standard deviations, by chance once in 1.7 million.
_JITTERS = 5.0 * MAD_TO_STD
#: Steps that the jitter is that of, and after which it is reckoned anew: an odd number, for a median.
_RECENT = 31
#: A crystal's rate moves by less than this while nothing is heard of it [ratio].
_WANDER = 1e-4
#: INFO's rate is off by less than this: the tolerance of an untrimmed oscillator, by data sheets [ratio].
INFO_OFF = 0.15
#: A clock below this ratio to its previous rate counts as halted: an eighth, a convention.
_LEAST = 1.0 / 8.0


class TickStep:
    """Measures the ticks of a sample.

    Parameters
    ----------
    claimed : float
        Ticks a sample by the device's INFO.
    tick_hz : float

    Attributes
    ----------
    ticks_per_sample : float
    measured : bool
        Whether enough steps were seen to tell a loss from a wrong INFO.
    """

    def __init__(self, claimed: float, tick_hz: float) -> None:
        self.ticks_per_sample = claimed
        self.measured = False
        self._mark_ticks, self._enough_ticks = _MARK_S * tick_hz, round(_ENOUGH_S * tick_hz)
        self._marks: deque[tuple[int, int]] = deque(maxlen=_MARKS)
        self._samples = 0
        self._span_ticks = 0
        self._steps = 0
        self._recent: deque[float] = deque(maxlen=_RECENT)
        self._strays: list[tuple[int, int]] = []
        self._first: list[tuple[int, int]] = []
        self._jitter = 0.0
        self._longest_samples = 0

    @property
    def std(self) -> float | None:
        """Relative standard error of the ticks of a sample; None where they are INFO's."""
        if self._span_ticks < _FEW_TICKS:
            return None
        return (_ROUNDING_TICKS + self._jitter) / self._span_ticks

    def late(self, step: float, samples: float) -> float:
        """Return by how many samples a step is longer than `samples` samples take."""
        return step / self.ticks_per_sample - samples

    @property
    def tolerance_ticks(self) -> float:
        """By how much the step of a frame may be off though nothing is lost."""
        return _HALF * self.ticks_per_sample + _ROUNDING_TICKS + self._jitter

    @property
    def back_ticks(self) -> float:
        """The least step that a clock makes which goes on."""
        return -(_ROUNDING_TICKS + self._jitter)

    def tolerance(self, samples: float = 0) -> float:
        """Return by how many samples a step may be off though nothing is lost; over more than a frame, by more."""
        one_step = _HALF + (_ROUNDING_TICKS + self._jitter) / self.ticks_per_sample
        if self.std is not None:
            off = 3.0 * self.std
        else:  # INFO's p, with which each step so far agreed as far as one step shows
            off = min(INFO_OFF, one_step / self._longest_samples) if self._longest_samples else INFO_OFF
        return one_step + (_WANDER + off) * samples

    def went_back(self, step: int) -> bool:
        """Say whether a step is one that no clock that goes on makes."""
        return step < self.back_ticks

    def begin(self, ticks: int) -> None:
        """Begin to measure at a frame before which something is missing; what was measured holds."""
        self._marks.clear()
        self._marks.append((0, ticks))
        self._samples = 0

    def go_on(self, step: int, samples: int, ticks: int, of_samples: int) -> None:
        """Take frames that followed without a loss.

        Parameters
        ----------
        step, samples : int
            Ticks and samples of the last of their steps.
        ticks : int
            Clock at the last frame.
        of_samples : int
            Samples of all of their steps.
        """
        self._strays.clear()
        self._samples += of_samples
        self._longest_samples = max(self._longest_samples, samples)
        self._steps += 1
        self._recent.append(abs(step - samples * self.ticks_per_sample))
        if not self.measured:
            self._first.append((step, samples))
        if self._steps == MAJORITY or self._steps % _RECENT == 0:
            self.measured = True
            self._first.clear()
            self._jitter = _JITTERS * median(self._recent)
        if not self._marks:
            return
        first_samples, first_ticks = self._marks[0]
        span, n = ticks - first_ticks, self._samples - first_samples
        enough = span >= max(_FEW_TICKS, min(self._span_ticks, self._enough_ticks))
        if n and (enough or abs(span - n * self.ticks_per_sample) > self.tolerance_ticks):
            self.ticks_per_sample, self._span_ticks = span / n, span
        if ticks >= self._marks[-1][1] + self._mark_ticks:
            self._marks.append((self._samples, ticks))

    def stray(self, step: int, samples: int) -> None:
        """Take a step that fits no p so far; as many as a majority in a row that agree are a new p."""
        self._strays.append((step, samples))
        if len(self._strays) == MAJORITY:
            self.changed(self._strays)
            self._strays.clear()

    def changed(self, steps: Sequence[tuple[int, int]], most: float = math.inf) -> bool:
        """Take steps in a row that fit no p so far; say whether they agree on another, which then holds.

        They agree as well as steps did before, or nothing is changed: a clock that shows anything has no p, nor
        has one that all but stands still.

        Parameters
        ----------
        most : float
            By what p may rise, where the host's clock was not asked [ratio].
        """
        p, span, measured, jitter = self.ticks_per_sample, self._span_ticks, self.measured, self._jitter
        first, recent = list(self._first), list(self._recent)
        self.decide(steps)
        limit = _HALF * self.ticks_per_sample + _ROUNDING_TICKS + jitter
        agreed = all(abs(ticks - samples * self.ticks_per_sample) <= limit for ticks, samples in steps)
        if agreed and _LEAST * p <= self.ticks_per_sample <= most * p:
            return self.ticks_per_sample != p
        self.ticks_per_sample, self._span_ticks, self.measured, self._jitter = p, span, measured, jitter
        self._first[:] = first
        self._recent.clear()
        self._recent.extend(recent)
        return False

    def decide(self, steps: Sequence[tuple[int, int]]) -> None:
        """Measure p from the majority of steps, each its ticks and its samples, and of those before.

        Rounding cancels between steps that follow each other, so the sum of all near the median tells more
        than one. INFO is right unless that sum contradicts it.
        """
        seen = len(self._first) + len(steps)
        steps = [one for one in (*self._first, *steps) if one[0] > 0]  # no sample takes no time
        self._first.clear()
        if not steps:
            return
        each = sorted(step / samples for step, samples in steps)
        middle_two = each[(len(each) - 1) // 2], each[len(each) // 2]
        middle = min(middle_two, key=lambda p: abs(p - self.ticks_per_sample))
        off = [abs(step - samples * middle) for step, samples in steps]
        limit = max(_JITTERS * median_low(off), _ROUNDING_TICKS)
        near = [one for one, distance in zip(steps, off, strict=True) if distance <= limit]
        if abs(middle / self.ticks_per_sample - 1.0) > INFO_OFF and (
            limit > _HALF * middle + _ROUNDING_TICKS or len(near) <= max(seen / 2, MAJORITY / 2)
        ):  # no majority agrees on what no oscillator is off by: a clock that shows anything
            self.measured = self.measured or seen >= MAJORITY
            return
        total, n = sum(step for step, _ in near), sum(samples for _, samples in near)
        pieces = 1 + len(steps) - len(near)
        if abs(total - n * self.ticks_per_sample) <= pieces * self.tolerance_ticks:
            self.measured = self.measured or len(near) >= MAJORITY
            return
        self.ticks_per_sample = total / n
        self._span_ticks = total
        self.measured = True
        self._recent.clear()
        self._recent.extend(abs(step - samples * self.ticks_per_sample) for step, samples in near)
        self._jitter = _JITTERS * median(self._recent)
