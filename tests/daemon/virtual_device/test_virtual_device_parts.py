"""A virtual device's clock, memory and hearing, part by part."""

import pytest

from daemon.virtual_device.virtual_device import TICK_HZ, CommandLine, FrameFifo, Timing


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


def test_much_is_written_in_pieces() -> None:
    fifo, asked = FrameFifo(200_000), list[int]()

    def write(data: bytes) -> int:
        asked.append(len(data))
        return len(data)

    fifo.put(bytes(65_536 + 10))
    fifo.drain(write)
    assert asked == [65_536, 10] and len(fifo) == 0


def test_only_whole_lines_are_commands_and_long_ones_are_cut() -> None:
    line = CommandLine()
    assert line.take(b"INFO\n START \r\nST") == [b"INFO", b"START"]
    assert line.take(b"OP\n\n") == [b"STOP", b""]
    line.take(b"x" * 100)
    assert line.take(b"\n") == [b"x" * 64]
    line.take(b"ST")
    line.forget()
    assert line.take(b"OP\n") == [b"OP"]
