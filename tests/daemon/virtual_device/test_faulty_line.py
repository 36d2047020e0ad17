"""What a bad wire does to frames, each kind as often as asked for."""

import numpy as np
import pytest

from daemon.virtual_device.faulty_line import FaultyLine
from daemon.virtual_device.virtual_device import FrameFifo

FRAME_BYTES = 100


def line(seed: int = 1, **acting: float) -> tuple[FaultyLine, FrameFifo]:
    fifo = FrameFifo(10**7)
    wire = FaultyLine(fifo, seed)
    wire.acting = acting
    return wire, fifo


def frames(n: int) -> list[bytes]:
    return [bytes([k % 251]) * FRAME_BYTES for k in range(n)]


def passed(fifo: FrameFifo) -> bytes:
    out = bytearray()

    def write(data: bytes) -> int:
        out.extend(data)
        return len(data)

    fifo.drain(write)
    return bytes(out)


def sent(n: int, **acting: float) -> tuple[FaultyLine, list[bytes]]:
    wire, fifo = line(**acting)
    for frame in frames(n):
        wire.put(frame)
    out = passed(fifo)
    return wire, [out[k : k + FRAME_BYTES] for k in range(0, len(out), FRAME_BYTES)]


def test_a_good_wire_changes_nothing() -> None:
    wire, came = sent(50)
    assert came == frames(50) and not wire.done


@pytest.mark.parametrize("kind", ["unplug", "restart", "silent"])
def test_nothing_passes_a_device_that_is_away(kind: str) -> None:
    wire, came = sent(7, **{kind: 0.0})
    assert came == [] and wire.done == {kind: 7}


def test_some_frames_are_lost_and_counted() -> None:
    wire, came = sent(2000, drop=0.1)
    assert len(came) == 2000 - wire.done["drop"]
    assert wire.done["drop"] == pytest.approx(200, abs=60)
    assert set(wire.done) == {"drop"}


def test_some_come_twice_one_after_the_other() -> None:
    wire, came = sent(200, double=0.2)
    again = sum(one == other for one, other in zip(came[:-1], came[1:], strict=True))
    assert len(came) == 200 + wire.done["double"] and again == wire.done["double"] > 10


def test_some_are_overtaken_by_the_next() -> None:
    wire, came = sent(4, reorder=1.0)
    a, b, c, d = frames(4)
    assert came == [b, a, d, c] and wire.done == {"reorder": 2}


def test_what_waits_to_be_overtaken_is_lost_with_the_line() -> None:
    wire, fifo = line(reorder=1.0)
    a, b, c, d = frames(4)
    wire.put(a)
    wire.put(b)
    wire.put(c)
    wire.cut()
    assert passed(fifo) == b""
    wire.acting = {}
    wire.put(d)
    assert passed(fifo) == d


def test_bits_are_turned_as_often_as_asked_for() -> None:
    wire, came = sent(500, flip=0.01)
    assert [len(one) for one in came] == [FRAME_BYTES] * 500
    differ = np.frombuffer(b"".join(came), np.uint8) ^ np.frombuffer(b"".join(frames(500)), np.uint8)
    hit = differ[differ > 0]
    assert np.isin(hit, 1 << np.arange(8)).all() and len(np.unique(hit)) == 8  # one bit of a byte, any of them
    assert len(hit) == pytest.approx(500, abs=110)
    assert wire.done["flip"] == sum(one != other for one, other in zip(came, frames(500), strict=True))


def test_at_another_baud_rate_all_is_noise() -> None:
    wire, came = sent(100, baud=1.0, flip=1.0)
    assert wire.done == {"baud": 100}
    counts = np.bincount(np.frombuffer(b"".join(came), np.uint8), minlength=256)
    assert len(b"".join(came)) == 100 * FRAME_BYTES and counts.max() < 100


def test_garbage_comes_at_its_rate() -> None:
    wire, fifo = line(garbage=5000.0)
    for _ in range(100):
        wire.rustle(0.01)
    assert len(passed(fifo)) == pytest.approx(5000, abs=300)
    wire.acting = {}
    wire.rustle(1.0)
    assert passed(fifo) == b""


def test_a_seed_draws_the_same_faults_again() -> None:
    def of(seed: int) -> bytes:
        wire, fifo = line(seed, flip=0.01, drop=0.1)
        for frame in frames(50):
            wire.put(frame)
        return passed(fifo)

    assert of(1) == of(1) != of(2)
