"""The virtual device by a clock of the test's: commands, timing, numbering, dropping."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from daemon.virtual_device.motion_source import MotionSource
from daemon.virtual_device.virtual_device import TICK_HZ, CommandLine, FrameFifo, Timing, VirtualDevice
from protocol.device_info import DeviceInfo
from protocol.serial_frame import InfoFrame, SamplesFrame
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info

RATE_HZ = 8000.0


class Ramp(MotionSource):
    """Samples that count up, as many as the test lets there be."""

    def __init__(self, available: int) -> None:
        self.taken = 0
        self.available = available
        self.closed = False

    def fetch(self) -> None:
        pass

    def take(self, n_sample: int) -> NDArray[np.int16] | None:
        if self.taken + n_sample > self.available:
            return None
        self.taken += n_sample
        return np.repeat(np.arange(self.taken - n_sample, self.taken, dtype=np.int16)[:, None], 12, axis=1)

    def truth(self) -> dict[str, NDArray[np.float64]]:
        return {"t": np.arange(self.taken) / RATE_HZ}

    def close(self) -> None:
        self.closed = True


class Bench:
    """A device, its sources and what comes out of it."""

    def __init__(
        self,
        info: DeviceInfo,
        available: int = 30_000,
        fifo_bytes: int = 10**6,
        speed: float = 1.0,
        patient: bool = False,
    ) -> None:
        self.sources: list[Ramp] = []
        self.available = available
        self.fifo = FrameFifo(fifo_bytes)
        self.parser = FrameParser()
        waits_for_host = self.fifo.is_half_full if patient else None
        self.device = VirtualDevice(
            info, self._source, self.fifo, speed, now_s=100.0, waits_for_host=waits_for_host
        )

    def _source(self) -> Ramp:
        self.sources.append(Ramp(self.available))
        return self.sources[-1]

    def taken(self) -> list[SamplesFrame | InfoFrame]:
        out = bytearray()

        def write(data: bytes) -> int:
            out.extend(data[:1000])
            return min(1000, len(data))

        while len(self.fifo):
            self.fifo.drain(write)
        return self.parser.feed(bytes(out))


@pytest.fixture
def bench() -> Callable[..., Bench]:
    return lambda **options: Bench(device_info(RATE_HZ), **options)


def test_commands_are_whole_lines_and_others_are_passed_over(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.device.receive(b"HELLO\nIN", 100.0)
    assert b.taken() == []
    b.device.receive(b"FO\r\n", 100.5)
    (frame,) = b.taken()
    assert isinstance(frame, InfoFrame)
    assert frame.ticks == TICK_HZ // 2
    b.device.receive(b"x" * 10_000, 100.5)
    b.device.receive(b"\nINFO\n", 100.5)
    assert len(b.taken()) == 1


def test_start_sends_info_and_then_what_is_due(bench: Callable[..., Bench]) -> None:
    b = bench(speed=2.0)
    b.device.receive(b"START\n", 101.0)
    for now_s in (101.05, 101.0999, 101.5):
        b.device.advance(now_s)
    info, *frames = b.taken()
    assert isinstance(info, InfoFrame)
    assert len(frames) == 8000 // 32  # half a second at twice the speed
    for k, frame in enumerate(frames):
        assert isinstance(frame, SamplesFrame)
        assert frame.sequence == k + 1
        assert frame.ticks == 2 * TICK_HZ + k * 32 * TICK_HZ // 8000
        np.testing.assert_array_equal(frame.counts[:, 5], np.arange(32) + 32 * k)


def test_dropped_frames_keep_their_numbers(bench: Callable[..., Bench]) -> None:
    b = bench(fifo_bytes=5000)
    b.device.receive(b"START\n", 100.0)
    b.device.advance(101.0)
    before = b.taken()
    assert b.fifo.dropped > 200
    b.device.advance(101.01)
    after = b.taken()
    last, first = before[-1], after[0]
    assert isinstance(last, SamplesFrame)
    assert isinstance(first, SamplesFrame)
    missing = first.sequence - last.sequence - 1
    assert missing == b.fifo.dropped
    assert first.ticks - last.ticks == (missing + 1) * 32 * TICK_HZ // 8000


def test_stop_ends_the_stream_and_start_begins_the_motions_anew(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.device.receive(b"START\n", 100.0)
    b.device.advance(100.1)
    b.device.receive(b"STOP\n", 100.1)
    b.device.advance(100.2)
    assert b.sources[0].closed
    before = b.taken()
    b.device.receive(b"STOP\nSTART\n", 100.3)
    b.device.advance(100.4)
    info, first, *_ = b.taken()
    assert len(b.sources) == 2
    assert isinstance(first, SamplesFrame)
    assert info.sequence == before[-1].sequence + 1
    assert first.ticks == info.ticks == round(0.3 * TICK_HZ)
    assert first.counts[0, 0] == 0


def test_start_while_streaming_only_introduces_again(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.device.receive(b"START\n", 100.0)
    b.device.advance(100.1)
    b.device.receive(b"START\n", 100.1)
    b.device.advance(100.2)
    frames = b.taken()
    assert [frame.sequence for frame in frames] == list(range(len(frames)))
    assert sum(isinstance(frame, InfoFrame) for frame in frames) == 2
    assert len(b.sources) == 1


def test_a_motion_that_is_computed_late_stops_the_devices_time(bench: Callable[..., Bench]) -> None:
    b = bench(available=0)
    b.device.receive(b"START\n", 100.0)
    b.device.advance(103.0)
    b.sources[0].available = 64
    b.device.advance(103.1)
    assert b.device.waited_s == pytest.approx(0.1 - 64 / 8000, abs=1e-6)  # until then it had not begun
    b.sources[0].available = 30_000
    b.device.advance(104.1)
    frames = [frame for frame in b.taken() if isinstance(frame, SamplesFrame)]
    assert len(frames) == 2 + 8000 // 32 - 1  # 7999.99 samples were due
    assert np.diff([frame.ticks for frame in frames]).tolist() == [32 * TICK_HZ // 8000] * (len(frames) - 1)


def test_the_truth_outlives_a_stop(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.device.receive(b"START\n", 100.0)
    b.device.advance(101.0)
    b.device.receive(b"STOP\n", 101.0)
    assert len(b.device.truth["t"]) == 8000
    b.device.close()
    assert all(source.closed for source in b.sources)


@pytest.mark.parametrize("awake_s", [0.0, 0.003])
def test_after_a_power_cut_the_clock_never_runs_backwards(bench: Callable[..., Bench], awake_s: float) -> None:
    one = bench(available=160)
    one.device.receive(b"START\n", 100.0)
    one.device.advance(100.02)
    one.device.restart(100.07)  # 50 ms after the last sample that there was
    one.device.receive(b"START\n", 100.07 + awake_s)
    one.device.advance(100.07 + awake_s)
    one.sources[-1].available = 10_000
    one.device.advance(100.2)
    ticks = [frame.ticks for frame in one.taken() if isinstance(frame, SamplesFrame)][5:]
    assert len(ticks) > 10
    assert ticks[0] >= 0
    assert set(np.diff(ticks)) == {32 * TICK_HZ // RATE_HZ}


def test_a_patient_device_waits_for_its_host_and_loses_nothing(bench: Callable[..., Bench]) -> None:
    """The host does not read for 2 s of a stream that fills the memory in a tenth of that."""
    b = bench(fifo_bytes=40_000, patient=True)
    b.device.receive(b"START\n", 100.0)
    for k in range(1, 201):
        b.device.advance(100.0 + 0.01 * k)
    assert b.fifo.dropped == 0 and b.fifo.is_half_full()
    frames = [frame for frame in b.taken() if isinstance(frame, SamplesFrame)]
    for k in range(201, 206):
        b.device.advance(100.0 + 0.01 * k)
        frames += [frame for frame in b.taken() if isinstance(frame, SamplesFrame)]
    values = np.concatenate([frame.counts[:, 0] for frame in frames])
    np.testing.assert_array_equal(values, np.arange(len(values)))
    ticks = np.diff([frame.ticks for frame in frames])
    assert np.ptp(ticks) <= 1  # its clock has stood still with it
    assert b.fifo.dropped == 0


def test_other_devices_wait_for_nobody(bench: Callable[..., Bench]) -> None:
    b = bench(fifo_bytes=40_000)
    b.device.receive(b"START\n", 100.0)
    for k in range(1, 201):
        b.device.advance(100.0 + 0.01 * k)
    assert b.fifo.dropped > 0


def test_a_device_that_was_without_power_counts_from_zero(bench: Callable[..., Bench]) -> None:
    one = bench()
    one.device.receive(b"START\n", 100.0)
    one.device.advance(100.5)
    one.taken()
    one.device.restart(100.6)
    one.device.receive(b"START\n", 100.7)
    one.device.advance(101.0)
    found = one.taken()
    assert isinstance(found[0], InfoFrame)
    assert [frame.sequence for frame in found[:4]] == [0, 1, 2, 3]


def test_a_device_is_ready_when_its_first_samples_are(
    bench: Callable[..., Bench], monkeypatch: pytest.MonkeyPatch
) -> None:
    b = bench()
    for there in (False, True):
        monkeypatch.setattr(b.sources[0], "wait", lambda _timeout_s, there=there: there)
        assert b.device.ready(0.0) == there
    assert b.device.started_s is None
    b.device.receive(b"START\n", 100.25)
    assert b.device.started_s == 100.25


@pytest.mark.parametrize(
    ("wraps_s", "on_s", "ticks"),
    [
        (None, 0.0, 0),
        (None, 500.0, 5_000_000_000),
        (3.0, 0.0, 2**32 - 30_000_000),
        (3.0, 2.9, 2**32 - 1_000_000),
        (3.0, 3.0, 0),
        (3.0, 3.5, 5_000_000),
        (0.0, 430.0, 4_300_000_000 - 2**32),
    ],
)
def test_a_narrow_counter_passes_zero_when_it_is_told_to(wraps_s: float | None, on_s: float, ticks: int) -> None:
    assert Timing(32_000.0, wraps_s=wraps_s).ticks(on_s) == ticks


def test_a_fast_clock_ticks_more() -> None:
    assert TICK_HZ == 10_000_000
    assert Timing(32_000.0, 1.5).ticks(2.0) == 30_000_000
    assert (Timing(1.0).frame_samples, Timing(1.0).clock, Timing(1.0).wraps_s) == (32, 1.0, None)


def test_a_frame_that_fills_the_memory_fits_and_one_more_byte_does_not() -> None:
    fifo = FrameFifo(10)
    fifo.put(b"12345")
    assert not fifo.is_half_full()
    fifo.put(b"6")
    assert fifo.is_half_full()
    fifo.put(b"78901")
    assert (len(fifo), fifo.dropped) == (6, 1)
    fifo.put(b"7890")
    assert (len(fifo), fifo.dropped) == (10, 1)
    fifo.clear()
    assert len(fifo) == 0 and not fifo.is_half_full() and fifo.dropped == 1


@pytest.mark.parametrize(
    ("takes", "calls", "left"), [([4, 4, 2], [10, 6, 2], 0), ([10], [10], 0), ([4], [10], 6), ([0], [10], 10)]
)
def test_the_host_takes_what_it_has_room_for(takes: list[int], calls: list[int], left: int) -> None:
    """A write that does not take all ends the turn."""
    fifo, asked, taken = FrameFifo(100), list[int](), bytearray()
    fifo.put(b"0123456789")
    while takes:
        count = takes.pop(0)

        def write(data: bytes, count: int = count) -> int:
            asked.append(len(data))
            taken.extend(data[:count])
            return min(count, len(data))

        fifo.drain(write)
    assert asked == calls and len(fifo) == left
    assert bytes(taken) == b"0123456789"[: 10 - left]


def test_only_whole_lines_are_commands_and_long_ones_are_cut() -> None:
    line = CommandLine()
    assert line.take(b"INFO\n START \r\nST") == [b"INFO", b"START"]
    assert line.take(b"OP\n\n") == [b"STOP", b""]
    line.take(b"x" * 100)
    assert line.take(b"\n") == [b"x" * 64]
    line.take(b"ST")
    line.forget()
    assert line.take(b"OP\n") == [b"OP"]
