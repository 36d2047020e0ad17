"""The book of samples: how many came, how many did not, when, for how long and why."""

from collections import Counter, deque
from dataclasses import dataclass
from operator import sub

from protocol.serial_frame import SEQUENCES, SamplesFrame, SamplesRun

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
        Whether the device's own count or clock tells the number; else the host's clock does.
    """

    sample0: int
    samples: int
    t_ns: int
    why: str
    exact: bool


class SampleLedger:
    """Accounts for every sample between the first and the last.

    A frame that never came leaves a hole in the sequence numbers, and its samples are counted by them. The
    device's clock is asked too, because a device that lost samples before it numbered them shows it only there.

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
    """

    def __init__(self, rate_hz: float, tick_hz: float) -> None:
        self.samples = 0
        self.lost_samples = 0
        self.gaps: deque[Gap] = deque(maxlen=_KEPT)
        self.causes: Counter[str] = Counter()
        self._samples_per_tick = rate_hz / tick_hz
        self._ticks_per_sample = tick_hz / rate_hz
        #: A clock that is read in whole ticks may be one off at either end; half a sample is nobody's.
        self._tolerance = 0.5 + 1.5 * self._samples_per_tick
        self._sequence: int | None = None
        self._skipped = 0
        self._told_ticks = 0
        self._due_ticks: float | None = None
        self._frame_samples = 0

    @property
    def position(self) -> int:
        """Number of the next sample, counting the lost ones."""
        return self.samples + self.lost_samples

    @property
    def due_ticks(self) -> int | None:
        """Device clock at the next sample; None before the first."""
        return None if self._due_ticks is None else round(self._due_ticks)

    def pass_over(self, sequence: int, ticks: int) -> None:
        """Note a frame that has a number and no samples, such as INFO; frames may be missing before it, too."""
        skipped = None if self._sequence is None else (sequence - self._sequence - 1) % SEQUENCES
        if skipped is None or skipped > SEQUENCES // 2:  # it begins to count, or anew
            self._skipped, self._told_ticks = 0, ticks
        else:
            self._skipped += skipped
        self._sequence = sequence

    def missing(self, frame: SamplesFrame) -> int | None:
        """Return how many samples are missing before a frame; None if the device has begun to count anew."""
        if self._due_ticks is None:
            return self._missing_at_first(frame)
        return self._missing(frame.sequence, frame.ticks)

    def goes_on(self, run: SamplesRun) -> bool:
        """Say whether no sample is missing before a run, nor between its frames."""
        if self._missing(run.sequence, run.ticks[0]) != 0:
            return False
        steps = [*map(sub, run.ticks[1:], run.ticks)]
        return all(  # the others lie between these
            abs(step * self._samples_per_tick - run.frame_samples) <= self._tolerance
            for step in ((min(steps), max(steps)) if steps else ())
        )

    def _missing_at_first(self, frame: SamplesFrame) -> int:
        """Return how many samples the device numbered since it said what it is, and before the first that came."""
        if self._sequence is None:
            return 0
        lost = (self._skipped + (frame.sequence - self._sequence - 1) % SEQUENCES) * len(frame.counts)
        most = (frame.ticks - self._told_ticks) * self._samples_per_tick + len(frame.counts) + self._tolerance
        return lost if lost <= most else 0  # else it has begun to count anew meanwhile

    def _missing(self, sequence: int, ticks: int) -> int | None:
        if self._due_ticks is None or self._sequence is None:
            return 0
        late = (ticks - self._due_ticks) * self._samples_per_tick
        skipped = (sequence - self._sequence - 1) % SEQUENCES
        by_number = (self._skipped + skipped) * self._frame_samples
        lost = by_number if abs(late - by_number) <= self._tolerance else round(late)
        return None if lost < 0 or skipped > SEQUENCES // 2 else lost

    def follows(self, frame: SamplesFrame) -> bool:
        """Say whether a frame's number is the next one."""
        return self._sequence is not None and frame.sequence == (self._sequence + 1) % SEQUENCES

    def enter(self, frame: SamplesFrame, lost: int) -> None:
        """Enter a frame, and so many samples that were lost before it."""
        self._enter(frame.sequence, frame.ticks, len(frame.counts))
        self.samples += len(frame.counts)
        self.lost_samples += lost

    def enter_run(self, run: SamplesRun) -> None:
        """Enter a run before which, and in which, nothing is missing."""
        last = run.sequence + len(run.ticks) - 1
        self._enter(last % SEQUENCES, run.ticks[-1], run.frame_samples)
        self.samples += len(run.counts)

    def _enter(self, sequence: int, ticks: int, n_sample: int) -> None:
        self._sequence, self._skipped = sequence, 0
        self._due_ticks = ticks + n_sample * self._ticks_per_sample
        self._frame_samples = n_sample

    def note(self, gap: Gap, cause: str | None = None) -> None:
        """Note why samples are missing; ``cause`` is what it counts by where the words are of this one gap."""
        self.gaps.append(gap)
        self.causes[cause or gap.why] += 1
