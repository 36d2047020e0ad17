"""Histories of a virtual device behind a line with faults, read by a host that may be busy; time is simulated."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from daemon.acquisition.ring import Chunk, Mark
from daemon.clock.host_clock import HostClock
from daemon.reception.reception import Reception
from daemon.reception.sample_ledger import Gap
from daemon.virtual_device.fault_injection import FaultInjection
from daemon.virtual_device.fault_schedule import KINDS, Fault
from daemon.virtual_device.faulty_line import FaultyLine
from daemon.virtual_device.virtual_device import TICK_HZ, FrameFifo, Timing, VirtualDevice
from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import InfoFrame
from protocol.serial_parser import FrameParser

BEGIN_S, SECONDS, TAIL_S = 100.0, 8.0, 1.5
UTC_NS = 1_800_000_000_000_000_000
#: Step of the simulated time, and how long a reader gathers bytes [s].
_STEP_S, _GATHER_S = 0.001, 0.006
#: Silence after which the reader sends START again, the longest pause between two, and that between INFOs [s].
_SILENT_S, _LAST_NUDGE_S, _ASK_S = 0.5, 2.0, 1.0
_DAMAGE = {"garbage": 3000.0, "flip": 3e-4, "drop": 0.05, "double": 0.05, "reorder": 0.05}
_TTY_BYTES = 65536


class Counted:
    """Samples that bear their own number."""

    def __init__(self) -> None:
        self.taken = 0

    def wait(self, _timeout_s: float) -> bool:
        return True

    def fetch(self) -> None:
        return

    def take(self, n: int) -> NDArray[np.int16]:
        number = np.arange(self.taken, self.taken + n)
        self.taken += n
        return np.stack([number & 0x7FFF, number >> 15, 7 * number % 30000], axis=1).astype(np.int16)

    def close(self) -> None:
        return


class Tty:
    """A port that can be pulled."""

    def __init__(self) -> None:
        self.plugged, self.times = True, 0
        self.held = bytearray()

    def unplug(self) -> None:
        self.plugged = False
        self.held.clear()

    def plug(self) -> None:
        self.plugged = True
        self.times += 1

    def write(self, data: bytes) -> int:
        room = min(len(data), _TTY_BYTES - len(self.held))
        self.held += data[:room]
        return room

    def read(self) -> bytes:
        data = bytes(self.held)
        self.held.clear()
        return data


def drawn_faults(rng: np.random.Generator) -> tuple[Fault, ...]:
    """Return one to four faults of any kind, of 50 ms to 2.5 s."""
    faults = []
    for kind in rng.choice(sorted(KINDS), rng.integers(1, 5)):
        start_s = float(rng.uniform(0.4, SECONDS - 2.0))
        lasts_s = float(np.exp(rng.uniform(np.log(0.05), np.log(2.5))))
        faults.append(
            Fault(str(kind), start_s, min(lasts_s, SECONDS - 1.5 - start_s), _DAMAGE.get(kind, 0.0), None)
        )
    return tuple(faults)


@dataclass
class Heard:
    """What the reception made of it.

    ``runs`` are the number of each run's first sample, and the numbers that its samples bear.
    """

    faults: tuple[Fault, ...]
    runs: list[tuple[int, NDArray[np.int64]]] = field(default_factory=list)
    gaps: list[Gap] = field(default_factory=list)

    def take(self, reception: Reception, chunks: list[Chunk] | None, now_ns: int) -> None:
        for run in reception.finish() if chunks is None else reception.take(chunks, now_ns):
            borne = np.rint(run.a).astype(np.int64)
            self.runs.append((run.sample0, borne[:, 0] + (borne[:, 1] << 15)))
        self.gaps += reception.new_gaps()


class _Reader:
    """Reads as `daemon.acquisition.reader` does: notes what became of the port, and sends START after silence."""

    def __init__(self, tty: Tty, device: VirtualDevice) -> None:
        self.tty, self._device = tty, device
        self._opened, self._times = True, tty.times
        self._heard_s = self._tried_s = self._asked_s = BEGIN_S
        self._nudge_s = self._pace_s = _SILENT_S

    def chunks(self, now_s: float, awaits_info: bool) -> Iterator[Chunk]:
        now_ns = round(1e9 * now_s)
        if self._opened and (not self.tty.plugged or self.tty.times != self._times):
            self._opened, self._tried_s = False, now_s + 0.05
            yield Chunk(now_ns, b"gone", Mark.LOST)
        elif not self._opened and self.tty.plugged and now_s >= self._tried_s:
            self._opened, self._times = True, self.tty.times
            self._rest(now_s)
            yield Chunk(now_ns, b"", Mark.OPENED)
            yield self.asked(b"START\n", now_s)
        elif self._opened and self.tty.held:
            self._rest(now_s)
            yield Chunk(now_ns, self.tty.read())
        elif self._opened and now_s > self._heard_s + self._nudge_s:
            self._nudge_s += self._pace_s
            self._pace_s = min(2.0 * self._pace_s, _LAST_NUDGE_S)
            yield self.asked(b"START\n", now_s)
        if self._opened and awaits_info and now_s > self._asked_s + _ASK_S:
            self._asked_s = now_s
            yield self.asked(b"INFO\n", now_s)

    def asked(self, command: bytes, now_s: float) -> Chunk:
        self._device.receive(command, now_s)
        return Chunk(round(1e9 * now_s), b"", Mark.ASKED)

    def _rest(self, now_s: float) -> None:
        self._heard_s, self._nudge_s, self._pace_s = now_s, _SILENT_S, _SILENT_S


def heard(seed: int, faults: tuple[Fault, ...] | None = None) -> Heard:
    """Return what a reception makes of a device whose line has faults; the host may be busy, rates are drawn."""
    rng = np.random.default_rng(seed)
    rate_hz, samples = float(rng.choice([1000.0, 4000.0])), int(rng.choice([4, 10, 32, 100]))
    off, busy = float(rng.choice([60e-6, 0.02]) * rng.uniform(-1.0, 1.0)), bool(rng.random() < 0.4)
    axes = tuple(Channel(f"s1{axis}", 1.0, 0.0, 40000.0) for axis in "xyz")
    info = DeviceInfo("counter", "1", "1", rate_hz, TICK_HZ, axes)
    out = Heard(drawn_faults(rng) if faults is None else faults)
    fifo, tty = FrameFifo(int(rng.choice([1 << 13, 1 << 16]))), Tty()
    line = FaultyLine(fifo, seed)
    timing = Timing(rate_hz * (1.0 + off), 1.0 + off, None, samples)
    device = VirtualDevice(info, Counted, line, 1.0, BEGIN_S, timing)  # type: ignore[arg-type]
    injection = FaultInjection(out.faults, info, device, line, tty)  # type: ignore[arg-type]
    reader, parser = _Reader(tty, device), FrameParser()
    device.receive(b"INFO\n", BEGIN_S)
    fifo.drain(tty.write)
    (introduction,) = parser.feed(tty.read())
    assert isinstance(introduction, InfoFrame)
    now = [round(1e9 * BEGIN_S)]
    reception = Reception(parser, introduction, HostClock(lambda: now[0] + UTC_NS, lambda: now[0]))
    out.take(reception, [reader.asked(b"START\n", BEGIN_S)], now[0])
    next_s = BEGIN_S
    for now_s in np.arange(BEGIN_S, BEGIN_S + SECONDS + TAIL_S, _STEP_S).tolist():
        injection.make(now_s)
        device.advance(now_s)
        fifo.drain(tty.write) if tty.plugged else fifo.clear()
        if now_s < next_s:
            continue
        stalls = rng.random() < (0.02 if busy else 0.002)
        next_s = now_s + _GATHER_S + rng.exponential(0.03 if busy else 0.004) + stalls * rng.uniform(0.05, 0.4)
        now[0] = round(1e9 * now_s)
        out.take(reception, [*reader.chunks(now_s, reception.awaits_info)], now[0])
    out.take(reception, None, now[0])
    return out
