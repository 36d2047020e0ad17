"""From bytes to accelerations, with holes where samples are missing."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from daemon.acquisition.ring import Chunk, Mark
from daemon.reception.reception import Reception
from daemon.reception.sample_runs import Run
from protocol.device_info import DeviceInfo
from protocol.serial_frame import InfoFrame, encode_info, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info, resting_counts

RATE_HZ = 8000.0
TICKS_PER_FRAME = 4000


def reception(info: DeviceInfo) -> Reception:
    return Reception(FrameParser(), InfoFrame(0, 0, info))


def chunk(*frames: bytes) -> list[Chunk]:
    return [Chunk(time.monotonic_ns(), b"".join(frames))]


def encoded(counts: NDArray[np.int16], ticks0: int = 50) -> list[bytes]:
    parts = counts.reshape(-1, 32, counts.shape[1])
    return [encode_samples(part, k + 1, ticks0 + k * TICKS_PER_FRAME) for k, part in enumerate(parts)]


def time_of(run: Run, sample: int) -> tuple[int, int]:
    """Return number and UTC [ns] of the first sample of the frame in which a sample came."""
    at, t_ns, _ = next(times for times in reversed(run.times) if times.sample0 <= sample).before(sample)
    return at, t_ns


def joined(runs: Sequence[Run]) -> NDArray[np.float64]:
    return np.concatenate([run.a for run in runs])


def test_counts_become_accelerations() -> None:
    info = device_info(RATE_HZ)
    info = replace(info, channels=tuple(replace(c, offset=0.5 * k) for k, c in enumerate(info.channels)))
    counts = resting_counts(320)
    (run,) = reception(info).take(chunk(*encoded(counts)))
    assert (run.lost, run.sample0, run.a.dtype) == (0, 0, np.float64)
    np.testing.assert_array_equal(run.a, counts * info.channels[0].scale + 0.5 * np.arange(12))


@given(lost=st.sets(st.integers(1, 18)), cut=st.integers(1, 19))
def test_every_hole_begins_a_run(lost: set[int], cut: int) -> None:
    counts = resting_counts(640)
    frames = encoded(counts)
    taker = reception(device_info(RATE_HZ))
    runs = []
    for part in (range(cut), range(cut, 20)):
        runs += taker.take(chunk(*(frames[k] for k in part if k not in lost)))
    runs += taker.finish()
    for run in runs:
        expected = counts[run.sample0 : run.sample0 + len(run.a)] * device_info().channels[0].scale
        np.testing.assert_array_equal(run.a, expected)
        for sample in range(run.sample0, run.sample0 + len(run.a), 16):
            at, t_ns = time_of(run, sample)
            assert at == sample - sample % 32
            assert abs(t_ns - time_of(runs[0], 0)[1] - round(at / RATE_HZ * 1e9)) <= 1
    assert sum(run.lost for run in runs) == 32 * len(lost) == taker.ledger.lost_samples
    assert len(joined(runs)) == 640 - 32 * len(lost) == taker.ledger.samples


def test_time_begins_with_the_hosts() -> None:
    (run,) = reception(device_info(RATE_HZ)).take(chunk(*encoded(resting_counts(800))))
    assert time.time_ns() - time_of(run, 0)[1] == pytest.approx(0.1e9, abs=0.05e9)


def test_an_info_in_between_is_no_loss() -> None:
    info, counts = device_info(RATE_HZ), resting_counts(64)
    one, two = counts[:32], counts[32:]
    taker = reception(info)
    stream = (encode_samples(one, 1, 0), encode_info(info, 2, 100), encode_samples(two, 3, TICKS_PER_FRAME))
    (run,) = taker.take(chunk(*stream))
    assert (run.lost, len(run.a)) == (0, 64)


def test_another_device_is_not_listened_to() -> None:
    info, counts = device_info(RATE_HZ), resting_counts(320)
    frames, taker = encoded(counts), reception(info)
    other = encode_info(replace(info, serial="other"), 2, 0)
    runs = taker.take(chunk(frames[0], other, *frames[2:5]))
    assert taker.awaits_info and taker.identity.stranger == "test device other"
    runs += taker.take(chunk(encode_info(info, 6, 0), *frames[6:])) + taker.finish()
    assert not taker.awaits_info and taker.identity.stranger is None
    assert [(run.sample0, run.lost, len(run.a)) for run in runs] == [(0, 0, 32), (192, 160, 128)]
    assert taker.identity.strangers == 4


def test_samples_that_wait_for_an_info_are_a_strangers_when_it_comes() -> None:
    info = device_info(RATE_HZ)
    frames, taker = encoded(resting_counts(160)), reception(info)
    taker.take(chunk(frames[0]))
    now_ns = time.monotonic_ns()
    taker.take(
        [Chunk(now_ns, b"", Mark.LOST), Chunk(now_ns, b"", Mark.OPENED), Chunk(now_ns, b"".join(frames[1:4]))]
    )
    assert taker.identity.strangers == 0
    taker.take(chunk(encode_info(replace(info, serial="other"), 5, 0)))
    assert taker.identity.strangers == 4  # three frames, and the INFO


def test_a_rate_is_known_after_a_quarter_of_a_second() -> None:
    taker = reception(device_info(RATE_HZ))
    assert not taker.knows_rate(time.monotonic_ns() + 10**12)
    at_ns = time.monotonic_ns()
    taker.take([Chunk(at_ns, b"".join(encoded(resting_counts(64))))], at_ns)
    assert not taker.knows_rate(at_ns + 240_000_000)
    assert taker.knows_rate(at_ns + 260_000_000)
    later = [encode_samples(resting_counts(32), 3, 50 + 2 * TICKS_PER_FRAME)]
    taker.take([Chunk(at_ns + 200_000_000, b"".join(later))], at_ns + 200_000_000)
    assert taker.knows_rate(at_ns + 260_000_000)


def test_a_slow_rate_is_known_after_some_frames() -> None:
    taker, at_ns = reception(device_info(50.0)), time.monotonic_ns()  # a frame every 0.64 s
    taker.take([Chunk(at_ns, encode_samples(resting_counts(32), 1, 50))], at_ns)
    assert not taker.knows_rate(at_ns + 1_900_000_000)
    assert taker.knows_rate(at_ns + 1_950_000_000)


def test_a_device_that_comes_back_says_first_what_it_is() -> None:
    info, counts = device_info(RATE_HZ), resting_counts(320)
    frames, taker = encoded(counts), reception(info)
    lost = Chunk(time.monotonic_ns(), b"pulled", Mark.LOST)
    opened = Chunk(time.monotonic_ns(), b"", Mark.OPENED)
    runs = taker.take([*chunk(*frames[:3], frames[3][:50]), lost, opened, *chunk(*frames[5:7])])
    assert taker.awaits_info and taker.connected and taker.reconnects == 1
    runs += taker.take(chunk(encode_info(info, 8, 0), *frames[8:])) + taker.finish()
    assert [(run.sample0, run.lost, len(run.a)) for run in runs] == [(0, 0, 96), (160, 64, 64), (256, 32, 64)]
    assert [(gap.sample0, gap.samples, gap.why, gap.exact) for gap in taker.new_gaps()] == [
        (96, 64, "unplugged", True),
        (224, 32, "lost in the device", False),
    ]


def test_what_was_sent_before_the_first_sample_that_came_is_missing() -> None:
    info, counts = device_info(RATE_HZ), resting_counts(640)
    frames, taker = encoded(counts), reception(info)
    lost = Chunk(time.monotonic_ns(), b"pulled", Mark.LOST)
    opened = Chunk(time.monotonic_ns(), b"", Mark.OPENED)
    said = encode_info(info, 11, 50 + 10 * TICKS_PER_FRAME)
    after = [encode_samples(counts[32 * k : 32 * k + 32], k + 2, 50 + k * TICKS_PER_FRAME) for k in range(12, 20)]
    runs = taker.take([*chunk(frames[0][:50]), lost, opened, *chunk(said, *after)])
    assert [(run.sample0, run.lost, len(run.a)) for run in runs] == [(384, 384, 256)]
    (gap,) = taker.new_gaps()
    assert (gap.sample0, gap.samples, gap.why) == (0, 384, "unplugged")
    assert not gap.exact  # some may have been numbers of INFO frames, and no clock tells before the first sample
    assert gap.t_ns == pytest.approx(time_of(runs[0], runs[0].sample0)[1] - 384 / RATE_HZ * 1e9, abs=1e6)


def test_a_device_that_counts_anew_before_its_first_sample_has_lost_none() -> None:
    taker = Reception(FrameParser(), InfoFrame(5, 10**9, device_info(RATE_HZ)))
    frames = encoded(resting_counts(320))
    runs = [*taker.take(chunk(*frames[6:])), *taker.finish()]
    assert (runs[0].sample0, sum(run.lost for run in runs)) == (0, 0) and taker.new_gaps() == []


def test_a_device_that_was_restarted_costs_what_the_hosts_clock_says() -> None:
    counts, taker = resting_counts(640), reception(device_info(RATE_HZ))
    now_ns = time.monotonic_ns()
    taker.take([Chunk(now_ns, b"".join(encoded(counts[:320])))])
    (run,) = taker.take([Chunk(now_ns + 540_000_000, b"".join(encoded(counts[320:], 20)))])
    assert run.lost == pytest.approx(0.5 * RATE_HZ, abs=1)
    (gap,) = taker.new_gaps()
    assert (gap.why, gap.exact, gap.samples) == ("the device was restarted", False, run.lost)
    assert gap.t_ns == pytest.approx(time_of(run, run.sample0)[1] - 0.5e9, abs=1e6)


def test_the_cause_of_a_gap_is_told() -> None:
    frames, taker = encoded(resting_counts(1280)), reception(device_info(RATE_HZ))
    hurt = bytes([*frames[1][:100], frames[1][100] ^ 1, *frames[1][101:]])
    taker.take(chunk(frames[0], hurt, *frames[2:8]))
    for _ in range(20):
        taker.take(chunk(b""))
    late = Chunk(time.monotonic_ns() + 10**9, b"".join(frames[20:25]))
    taker.take([late])
    taker.dropped()
    taker.take([Chunk(late.stamp_ns + 1, b"".join(frames[30:35]))])
    jumped = [encode_samples(np.zeros((32, 12), dtype=np.int16), 36, 50 + 39 * TICKS_PER_FRAME)]
    taker.take([Chunk(late.stamp_ns + 2, b"".join(jumped))])
    taker.finish()
    assert [(gap.why, gap.samples) for gap in taker.new_gaps()] == [
        ("damaged on the line", 32),
        ("the device was silent", 12 * 32),
        ("the daemon fell behind", 5 * 32),
        ("lost in the device", 4 * 32),
    ]


def test_what_waits_for_a_frame_is_given_out_at_the_end() -> None:
    frames, taker = encoded(resting_counts(160)), reception(device_info(RATE_HZ))
    assert len(taker.take(chunk(frames[0], frames[2]))) == 1
    (run,) = taker.finish()
    assert (run.lost, len(run.a)) == (32, 32)


def test_a_frame_does_not_wait_for_another_for_long() -> None:
    frames, taker = encoded(resting_counts(160)), reception(device_info(RATE_HZ))
    taker.take(chunk(frames[0], frames[2]))
    assert taker.take([], time.monotonic_ns()) == []
    assert len(taker.take([], time.monotonic_ns() + 10**8)) == 1
