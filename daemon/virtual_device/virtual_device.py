"""The virtual device without its wire: commands in, frames out, by the clock."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from arm.counts import COUNT_M_S2, COUNT_RAD_S, FULL_SCALE_M_S2, FULL_SCALE_RAD_S
from arm.model import Arm
from daemon.virtual_device.bench_plan import Truth
from daemon.virtual_device.motion_source import MotionSource
from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import encode_info, encode_samples

#: Samples a frame, unless said otherwise: 1 ms at 32 kHz.
FRAME_SAMPLES = 32
#: Ticks a second of its clock [Hz].
TICK_HZ = 10_000_000
#: What a narrow tick counter counts to.
_NARROW = 1 << 32
#: Bytes of a command that has no end yet which are kept; the longest one of the protocol has some ten.
_LONGEST_COMMAND = 64
#: Bytes handed to the line at once.
_WRITE_BYTES = 65536


@dataclass(frozen=True)
class Timing:
    """When a virtual device samples, and what its clock shows.

    Attributes
    ----------
    sampled_hz : float
        Samples in a second of the host's, whatever INFO says.
    clock : float
        Seconds of the device's clock in one of the host's.
    wraps_s : float or None
        Its tick counter has 32 bits, and passes zero at this time after it was switched on; with None it has 64.
    frame_samples : int
    """

    sampled_hz: float
    clock: float = 1.0
    wraps_s: float | None = None
    frame_samples: int = FRAME_SAMPLES

    def ticks(self, on_s: float) -> int:
        """Return what the counter shows at this time of the host's [s] after the device was switched on."""
        ticks = round(on_s * self.clock * TICK_HZ)
        return ticks if self.wraps_s is None else (ticks - round(self.wraps_s * TICK_HZ)) % _NARROW


class FrameFifo:
    """The device's memory for frames that the host has not taken yet; a frame that does not fit is dropped.

    Attributes
    ----------
    dropped : int
        Frames dropped.
    """

    def __init__(self, capacity_bytes: int) -> None:
        self.dropped = 0
        self._capacity = capacity_bytes
        self._held = bytearray()

    def __len__(self) -> int:
        return len(self._held)

    def put(self, frame: bytes) -> None:
        """Add a whole frame, or drop it."""
        if len(self._held) + len(frame) > self._capacity:
            self.dropped += 1
        else:
            self._held += frame

    def is_half_full(self) -> bool:
        """Say whether the host has left these bytes unread."""
        return 2 * len(self._held) > self._capacity

    def clear(self) -> None:
        """Lose all that is held."""
        self._held.clear()

    def drain(self, write: Callable[[bytes], int]) -> None:
        """Write for as long as everything is accepted; ``write`` returns how many bytes it took."""
        while self._held:
            data = bytes(self._held[:_WRITE_BYTES])
            accepted = write(data)
            del self._held[:accepted]
            if accepted < len(data):
                return


def device_info(arm: Arm, rate_hz: float, seed: int) -> DeviceInfo:
    """Return what the virtual device says of itself."""
    first = 3 * len(arm.sensors)
    channels = tuple(Channel(name, COUNT_M_S2, 0.0, FULL_SCALE_M_S2) for name in arm.channels[:first])
    channels += tuple(Channel(name, COUNT_RAD_S, 0.0, FULL_SCALE_RAD_S) for name in arm.channels[first:])
    return DeviceInfo("limbcal virtual arm", f"seed-{seed}", "1", rate_hz, TICK_HZ, channels)


class CommandLine:
    """What a device hears. Only whole lines are commands."""

    def __init__(self) -> None:
        self._rest = b""

    def take(self, data: bytes) -> list[bytes]:
        """Take bytes of the host; return the commands that they complete."""
        *lines, rest = (self._rest + data).split(b"\n")
        self._rest = rest[-_LONGEST_COMMAND:]
        return [line.strip() for line in lines]

    def forget(self) -> None:
        """Forget what is not a whole line yet."""
        self._rest = b""


class Line(Protocol):
    """What takes a device's frames."""

    def put(self, frame: bytes) -> None:
        """Take a whole frame."""


class VirtualDevice:
    """Answers INFO, START and STOP, and makes the frames that are due.

    The arm begins its motions at START. Sequence numbers and the device's clock go on while it is on.

    Parameters
    ----------
    info : DeviceInfo
    new_source : callable
        Returns the motions, from their beginning.
    line : Line
        Where frames go.
    speed : float
        How many times faster than in real time everything goes.
    now_s : float
        The host's clock.
    timing : Timing, optional
        As INFO says unless given.
    waits_for_host : callable, optional
        Says whether the host is so far behind that arm and clock wait for it; they never do unless given, as a
        real arm never does.

    Attributes
    ----------
    waited_s : float
        How long the stream, once begun, had to wait: for samples that were not computed yet, or for the host.
    """

    def __init__(
        self,
        info: DeviceInfo,
        new_source: Callable[[], MotionSource],
        line: Line,
        speed: float,
        now_s: float,
        timing: Timing | None = None,
        waits_for_host: Callable[[], bool] | None = None,
    ) -> None:
        self.waited_s = 0.0
        self._waits_for_host = waits_for_host or (lambda: False)
        self._info = info
        self._timing = timing or Timing(info.rate_hz)
        self._new_source = new_source
        self._source = new_source()
        self._out = line
        self._awaits_start = False
        self._speed = speed
        self._on_s = now_s
        self._commands = CommandLine()
        self._sequence = 0
        self._streaming = False
        self._started_s = 0.0
        self._truth: Truth = {}

    @property
    def truth(self) -> Truth:
        """The true motion of the stream that is, or was, the last."""
        return self._source.truth() if self._streaming else self._truth

    def ready(self, timeout_s: float) -> bool:
        """Wait for the first samples; return whether they are there.

        Raises
        ------
        LimbcalError
            If the motions cannot be computed.
        """
        if not self._source.wait(timeout_s):
            return False
        self._source.fetch()
        return True

    def receive(self, data: bytes, now_s: float) -> None:
        """Take what the host sent; what is no command is passed over."""
        for command in self._commands.take(data):
            if command in (b"INFO", b"START"):
                self._put(encode_info(self._info, self._sequence, self._ticks(now_s)))
            if command == b"START":
                self._awaits_start = False
            if command == b"START" and not self._streaming:
                self._streaming = True
                self._started_s = now_s
            elif command == b"STOP" and self._streaming:
                self._stop()

    def advance(self, now_s: float) -> None:
        """Make the frames that are due by now.

        Raises
        ------
        LimbcalError
            If the motions cannot be computed.
        """
        self._source.fetch()
        if not self._streaming:
            return
        per_s, n = self._timing.sampled_hz * self._speed, self._timing.frame_samples
        due = int((now_s - self._started_s) * per_s)
        while due - self._source.taken >= n:
            first_s = self._started_s + self._source.taken / per_s
            counts = None if self._waits_for_host() else self._source.take(n)
            if counts is None:
                self._stand_still(first_s, now_s)
                return
            if not self._awaits_start and first_s >= self._on_s:  # else it was without power when it was due
                self._put(encode_samples(counts, self._sequence, self._ticks(first_s)))

    @property
    def started_s(self) -> float | None:
        """When the stream began, by the host's clock; None where there is none."""
        return self._started_s if self._streaming else None

    def restart(self, now_s: float) -> None:
        """Begin clock and numbers anew and wait for START; the arm does not care."""
        self._on_s, self._sequence, self._awaits_start = now_s, 0, True
        self._commands.forget()

    def become(self, info: DeviceInfo) -> None:
        """Be another device from now on."""
        self._info = info

    def close(self) -> None:
        """Stop computing motions."""
        self._source.close()

    def _stop(self) -> None:
        self._truth = self._source.truth()
        self._streaming = False
        self._source.close()
        self._source = self._new_source()

    def _stand_still(self, first_s: float, now_s: float) -> None:
        """Let the arm and its clock wait, as if no time had passed."""
        wait_s = now_s - first_s
        self._started_s += wait_s
        self._on_s = min(self._on_s + wait_s, now_s)  # a clock that began meanwhile has waited no longer
        if self._source.taken:
            self.waited_s += wait_s

    def _put(self, frame: bytes) -> None:
        self._sequence += 1
        self._out.put(frame)

    def _ticks(self, at_s: float) -> int:
        return self._timing.ticks((at_s - self._on_s) * self._speed)
