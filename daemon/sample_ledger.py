"""The book of samples: how many came, how many did not, told by sequence numbers and the device's clock."""

from limbcal.errors import DeviceError
from protocol.serial_frame import SamplesFrame

_SEQUENCES = 1 << 32


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
    """

    def __init__(self, rate_hz: float, tick_hz: float) -> None:
        self.samples = 0
        self.lost_samples = 0
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

    def pass_over(self, sequence: int) -> None:
        """Note a frame that has a number and no samples, such as INFO."""
        self._sequence = sequence

    def enter(self, frame: SamplesFrame) -> int:
        """Enter a frame; return how many samples were lost between the one before and this one.

        Raises
        ------
        DeviceError
            If the device's clock went back: it was restarted, and nothing says for how long.
        """
        n_sample = len(frame.counts)
        lost = 0
        if self._due_ticks is not None:
            late = (frame.ticks - self._due_ticks) * self._samples_per_tick
            by_number = self._missing_frames(frame.sequence) * self._frame_samples
            lost = by_number if abs(late - by_number) <= self._tolerance else round(late)
            if lost < 0:
                raise DeviceError(
                    f"serial frame {frame.sequence}: the device's clock is at {frame.ticks} ticks, "
                    f"expected {self._due_ticks:.0f} or more: the device was restarted"
                )
        self._sequence = frame.sequence
        self._due_ticks = frame.ticks + n_sample * self._ticks_per_sample
        self._frame_samples = n_sample
        self.samples += n_sample
        self.lost_samples += lost
        return lost

    def _missing_frames(self, sequence: int) -> int:
        return 0 if self._sequence is None else (sequence - self._sequence - 1) % _SEQUENCES
