"""The book of samples: how many came, how many did not, when, for how long and why."""

from collections import Counter, deque
from dataclasses import dataclass

from protocol.serial_frame import SamplesFrame

_SEQUENCES = 1 << 32
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

    def pass_over(self, sequence: int) -> None:
        """Note a frame that has a number and no samples, such as INFO."""
        self._sequence = sequence

    def missing(self, frame: SamplesFrame) -> int | None:
        """Return how many samples are missing before a frame; None if the device has begun to count anew."""
        if self._due_ticks is None or self._sequence is None:
            return 0
        late = (frame.ticks - self._due_ticks) * self._samples_per_tick
        skipped = (frame.sequence - self._sequence - 1) % _SEQUENCES
        by_number = skipped * self._frame_samples
        lost = by_number if abs(late - by_number) <= self._tolerance else round(late)
        return None if lost < 0 or skipped > _SEQUENCES // 2 else lost

    def follows(self, frame: SamplesFrame) -> bool:
        """Say whether a frame's number is the next one."""
        return self._sequence is not None and frame.sequence == (self._sequence + 1) % _SEQUENCES

    def enter(self, frame: SamplesFrame, lost: int) -> None:
        """Enter a frame, and so many samples that were lost before it."""
        n_sample = len(frame.counts)
        self._sequence = frame.sequence
        self._due_ticks = frame.ticks + n_sample * self._ticks_per_sample
        self._frame_samples = n_sample
        self.samples += n_sample
        self.lost_samples += lost

    def note(self, gap: Gap) -> None:
        """Note why samples are missing."""
        self.gaps.append(gap)
        self.causes[gap.why] += 1
