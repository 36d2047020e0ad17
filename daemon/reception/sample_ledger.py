"""The book of samples: how many came, how many did not, when, for how long and why."""

from collections import Counter, deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import sub

from daemon.clock.tick_step import INFO_OFF, TickStep
from daemon.reception.frame_sizes import FrameSizes
from protocol.serial_frame import HALF_WAY, SEQUENCES, SamplesFrame, SamplesRun

#: Gaps are kept, the last ones; all of them are in the recording and the sums.
_KEPT = 16


@dataclass(frozen=True)
class Gap:
    """Samples that never came.

    Attributes
    ----------
    sample0 : int
        Number of the first of them.
    samples : int
    t_ns : int
        UTC of the first of them [ns].
    why : str
        A cause in few words, such as ``unplugged``.
    exact : bool
        Whether the numbers of frames, all of one size, tell how many, and the device's clock agrees; else one of
        both clocks does.
    """

    sample0: int
    samples: int
    t_ns: int
    why: str
    exact: bool


class SampleLedger:
    """Accounts for every sample between the first and the last.

    A frame that never came leaves a hole in the sequence numbers, and its samples are counted by them. How many it
    had the numbers tell only where all frames are of one size; of others they tell between which bounds, those of
    the smallest and the largest frame that was seen, and the device's clock tells the rest. The clock is asked in
    any case, because a device that lost samples before it numbered them shows it only there: a step of the clock
    that is longer than its samples take, by the ticks of a sample that `TickStep` measures.

    Parameters
    ----------
    rate_hz, tick_hz : float
        Of the device's INFO.

    Attributes
    ----------
    samples, lost_samples : int
        What came, and what did not.
    gaps : deque of Gap
        The last ones.
    causes : Counter of str
        Gaps by cause.
    step : TickStep
        The ticks of a sample.
    numbers_anew : bool
        Whether an INFO since the last samples has a number that those between cannot have led to.
    """

    def __init__(self, rate_hz: float, tick_hz: float) -> None:
        self.samples = 0
        self.lost_samples = 0
        self.gaps: deque[Gap] = deque(maxlen=_KEPT)
        self.causes: Counter[str] = Counter()
        self.step = TickStep(tick_hz / rate_hz, tick_hz)
        self._sequence: int | None = None
        self._skipped = 0
        self._announced_ticks = 0
        self.numbers_anew = False
        self._announced_anew = self._restarted = False
        self._ticks: int | None = None
        self._frame_samples = 0
        self._sizes = FrameSizes()

    @property
    def position(self) -> int:
        """Number of the next sample, counting the lost ones."""
        return self.samples + self.lost_samples

    @property
    def due_ticks(self) -> int | None:
        """Device clock at the next sample; None before the first."""
        if self._ticks is None:
            return None
        return round(self._ticks + self._frame_samples * self.step.ticks_per_sample)

    @property
    def frame_samples(self) -> int:
        """Samples of the last frame."""
        return self._frame_samples

    def pass_over(self, sequence: int, ticks: int) -> None:
        """Note a frame that has a number and no samples, such as INFO; frames may be missing before it, too."""
        skipped = None if self._sequence is None else (sequence - self._sequence - 1) % SEQUENCES
        self._announced_anew = self._went_back(ticks)
        if skipped is None or skipped > HALF_WAY:  # it begins to count, or anew
            self._skipped, self._announced_ticks = 0, ticks
            self.numbers_anew = not self._may_have_numbered(HALF_WAY, ticks)
        else:
            self._skipped += skipped
        self._sequence = sequence

    def doubts(self, frame: SamplesFrame) -> bool:
        """Say whether a frame contradicts the rate of INFO while too few came to tell whether INFO is right.

        So does one before which only the clock could tell how many samples are missing. `decide` with it and the
        frames after it settles that.
        """
        if self._ticks is None or self._sequence is None or self.step.measured or self._went_back(frame.ticks):
            return False
        frames, sizes = self.frames_before(frame), self.sizes_with(frame)
        late = self.step.late(frame.ticks - self._ticks, self._frame_samples)
        by_number = sizes.nearest(frames, late)
        only_clock = frames > 0 and not sizes.are_one
        return frames <= HALF_WAY and (only_clock or abs(late - by_number) > self.step.tolerance(by_number))

    def decide(self, frames: Sequence[SamplesFrame]) -> None:
        """Measure the ticks of a sample from frames that are to be entered."""
        stamps = [(one.sequence, one.ticks, len(one.counts)) for one in frames]
        if self._ticks is not None and self._sequence is not None:
            stamps.insert(0, (self._sequence, self._ticks, self._frame_samples))
        self.step.decide(
            [
                (ticks - last_ticks, samples)
                for (last, last_ticks, samples), (sequence, ticks, _) in pairwise(stamps)
                if sequence == (last + 1) % SEQUENCES and not self.step.went_back(ticks - last_ticks)
            ]
        )

    def missing(self, frame: SamplesFrame) -> int | None:
        """Return how many samples are missing before a frame; None if the device has begun to count anew."""
        if self._ticks is None:
            return self._missing_at_first(frame)
        return self._missing(frame)

    def goes_on(self, run: SamplesRun) -> bool:
        """Say whether no sample is missing before a run, nor between its frames."""
        if self._ticks is None or not self._in_sequence(run.sequence):
            return False
        ticks, p, most = run.ticks, self.step.ticks_per_sample, self.step.tolerance_ticks
        if abs(ticks[0] - self._ticks - self._frame_samples * p) > most:
            return False
        steps, due = [*map(sub, ticks[1:], ticks)], run.frame_samples * p
        return not steps or bool(due - min(steps) <= most and max(steps) - due <= most)

    def begun_anew(self, frame: SamplesFrame) -> bool:
        """Say whether a device was restarted before a frame, by its INFO or by the frame's number."""
        if self._sequence is None or self._restarted or not self._went_back(frame.ticks):
            return self._restarted
        return self._announced_anew or (frame.sequence - self._sequence - 1) % SEQUENCES > HALF_WAY

    def restarted(self) -> None:
        """Note that a device which numbers anew has begun its clock anew, too, although that shows more."""
        self._restarted = True

    def in_sequence(self, frame: SamplesFrame) -> bool:
        """Say whether no frame is missing before one, by number."""
        return self._in_sequence(frame.sequence)

    def number_after(self, sequence: int) -> int:
        """Return the number of the frame after one."""
        return (sequence + 1) % SEQUENCES

    def numbered(self, frame: SamplesFrame) -> int:
        """Return how many samples are missing before a frame by number, if in frames like the one before."""
        return self.frames_before(frame) * (self._frame_samples or len(frame.counts))

    def fewest_numbered(self, frame: SamplesFrame) -> int:
        """Return how many samples are missing before a frame by number at the least."""
        return round(self.nearest_numbered(frame, 0.0))

    def nearest_numbered(self, frame: SamplesFrame, by_clock: float) -> float:
        """Return how many samples may be missing before a frame by number, nearest to how many are by a clock."""
        return self.sizes_with(frame).nearest(self.frames_before(frame), by_clock)

    def frames_before(self, frame: SamplesFrame) -> int:
        """Return how many frames are missing before one, by number."""
        return 0 if self._sequence is None else self._skipped + (frame.sequence - self._sequence - 1) % SEQUENCES

    def sizes_with(self, frame: SamplesFrame) -> FrameSizes:
        """Return the sizes of all frames and of this one."""
        return self._sizes.with_frame(len(frame.counts))

    def _went_back(self, ticks: int) -> bool:
        return self._ticks is not None and self.step.went_back(ticks - self._ticks)

    def _may_have_numbered(self, frames: int, ticks: int) -> bool:
        """Say whether the clock left a device enough time since the last frame to number this many."""
        if self._ticks is None:
            return True
        return self.step.late(ticks - self._ticks, 0) >= frames * self._sizes.smallest / (1.0 + INFO_OFF)

    def _step_to(self, frame: SamplesFrame) -> int | None:
        """Return the ticks to a frame that follows the last one; None for any other."""
        if self._ticks is None or self._restarted or not self._in_sequence(frame.sequence):
            return None
        return None if self._went_back(frame.ticks) else frame.ticks - self._ticks

    def _in_sequence(self, sequence: int) -> bool:
        return not self._skipped and self._sequence is not None and sequence == (self._sequence + 1) % SEQUENCES

    def _missing_at_first(self, frame: SamplesFrame) -> int:
        """Return how many samples the device numbered since it said what it is, and before the first that came."""
        if self._sequence is None:
            return 0
        lost = self.frames_before(frame) * len(frame.counts)
        elapsed = (frame.ticks - self._announced_ticks) / self.step.ticks_per_sample
        most = elapsed + len(frame.counts) + self.step.tolerance(abs(elapsed))
        return lost if lost <= most else 0  # else it has begun to count anew meanwhile

    def _missing(self, frame: SamplesFrame) -> int | None:
        assert self._ticks is not None
        assert self._sequence is not None
        number = (frame.sequence - self._sequence - 1) % SEQUENCES
        if self._restarted or number > HALF_WAY or self._went_back(frame.ticks):
            return None
        late = self.step.late(frame.ticks - self._ticks, self._frame_samples)
        by_number = self.nearest_numbered(frame, late)
        return max(0, round(by_number if abs(late - by_number) <= self.step.tolerance(by_number) else late))

    def resolves(self, lost: int, samples: float) -> bool:
        """Say whether the clock counts a number of lost samples to within ``samples``; not before the first."""
        return self._ticks is not None and self.step.tolerance(lost) < samples

    def follows(self, frame: SamplesFrame) -> bool:
        """Say whether a frame's number is the next one."""
        return self._sequence is not None and frame.sequence == (self._sequence + 1) % SEQUENCES

    def enter(self, frame: SamplesFrame, lost: int) -> None:
        """Enter a frame, and the number of samples lost before it."""
        step = self._step_to(frame)
        if step is not None and not lost:
            self.step.go_on(step, self._frame_samples, frame.ticks, self._frame_samples)
        else:
            if step is not None:
                self.step.stray(step, self._frame_samples)
            self.step.begin(frame.ticks)
        n = len(frame.counts)
        self._sizes = self.sizes_with(frame)
        self._sequence, self._skipped, self._ticks, self._frame_samples = frame.sequence, 0, frame.ticks, n
        self.numbers_anew = self._announced_anew = self._restarted = False
        self.samples += n
        self.lost_samples += lost

    def enter_run(self, run: SamplesRun) -> None:
        """Enter a run before which, and in which, nothing is missing."""
        n, count = run.frame_samples, len(run.ticks)
        assert self._ticks is not None
        before, samples = (run.ticks[-2], n) if count > 1 else (self._ticks, self._frame_samples)
        self.step.go_on(run.ticks[-1] - before, samples, run.ticks[-1], self._frame_samples + (count - 1) * n)
        self._sequence = (run.sequence + count - 1) % SEQUENCES
        self._ticks, self._frame_samples = run.ticks[-1], n
        self._sizes = self._sizes.with_frame(n)
        self.samples += len(run.counts)

    def note(self, gap: Gap, cause: str | None = None) -> None:
        """Note why samples are missing; ``cause`` is what it counts by where the words are of this one gap."""
        self.gaps.append(gap)
        self.causes[cause or gap.why] += 1
