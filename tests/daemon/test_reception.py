"""From bytes to accelerations, with holes where samples are missing."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from daemon.reception import Reception, Run
from daemon.ring import Chunk
from limbcal.errors import DeviceError
from protocol.serial_frame import DeviceInfo, InfoFrame, encode_info, encode_samples
from protocol.serial_parser import FrameParser

MakeInfo = Callable[..., DeviceInfo]
RATE_HZ = 8000.0
TICKS_PER_FRAME = 4000


def reception(info: DeviceInfo) -> Reception:
    return Reception(FrameParser(), InfoFrame(0, 0, info), "/dev/ttyX")


def chunk(*frames: bytes) -> list[Chunk]:
    return [Chunk(time.monotonic_ns(), b"".join(frames))]


def encoded(counts: NDArray[np.int16]) -> list[bytes]:
    parts = counts.reshape(-1, 32, counts.shape[1])
    return [encode_samples(part, k + 1, 50 + k * TICKS_PER_FRAME) for k, part in enumerate(parts)]


def joined(runs: Sequence[Run]) -> NDArray[np.float64]:
    return np.concatenate([run.a for run in runs])


def test_counts_become_accelerations(
    make_info: MakeInfo, random_counts: Callable[[int], NDArray[np.int16]]
) -> None:
    info = make_info(RATE_HZ)
    info = replace(info, channels=tuple(replace(c, offset=0.5 * k) for k, c in enumerate(info.channels)))
    counts = random_counts(320)
    (run,) = reception(info).take(chunk(*encoded(counts)))
    assert (run.lost, run.sample0, run.a.dtype) == (0, 0, np.float64)
    np.testing.assert_array_equal(run.a, counts * info.channels[0].scale + 0.5 * np.arange(12))


@given(lost=st.sets(st.integers(1, 18)), cut=st.integers(1, 19))
def test_every_hole_begins_a_run(
    lost: set[int], cut: int, make_info: MakeInfo, random_counts: Callable[[int], NDArray[np.int16]]
) -> None:
    counts = random_counts(640)
    frames = encoded(counts)
    taker = reception(make_info(RATE_HZ))
    runs = []
    for part in (range(cut), range(cut, 20)):
        runs += taker.take(chunk(*(frames[k] for k in part if k not in lost)))
    for run in runs:
        expected = counts[run.sample0 : run.sample0 + len(run.a)] * make_info().channels[0].scale
        np.testing.assert_array_equal(run.a, expected)
        assert abs(run.t0_ns - runs[0].t0_ns - round(run.sample0 / RATE_HZ * 1e9)) <= 1
    assert sum(run.lost for run in runs) == 32 * len(lost) == taker.ledger.lost_samples
    assert len(joined(runs)) == 640 - 32 * len(lost) == taker.ledger.samples


def test_time_begins_with_the_hosts(
    make_info: MakeInfo, random_counts: Callable[[int], NDArray[np.int16]]
) -> None:
    (run,) = reception(make_info(RATE_HZ)).take(chunk(*encoded(random_counts(800))))
    assert time.time_ns() - run.t0_ns == pytest.approx(0.1e9, abs=0.05e9)


def test_an_info_in_between_is_no_loss(
    make_info: MakeInfo, random_counts: Callable[[int], NDArray[np.int16]]
) -> None:
    info, counts = make_info(RATE_HZ), random_counts(64)
    one, two = counts[:32], counts[32:]
    taker = reception(info)
    stream = (encode_samples(one, 1, 0), encode_info(info, 2, 100), encode_samples(two, 3, TICKS_PER_FRAME))
    (run,) = taker.take(chunk(*stream))
    assert (run.lost, len(run.a)) == (0, 64)


def test_a_device_that_describes_itself_otherwise(make_info: MakeInfo) -> None:
    with pytest.raises(DeviceError, match="INFO frame 9 differs from the first one"):
        reception(make_info(RATE_HZ)).take(chunk(encode_info(make_info(16000.0), 9, 0)))


def test_frames_of_another_width(make_info: MakeInfo) -> None:
    narrow = encode_samples(np.zeros((32, 6), dtype=np.int16), 4, 0)
    with pytest.raises(DeviceError, match="frame 4 has 6 channels, expected 12 as the device's INFO says"):
        reception(make_info(RATE_HZ)).take(chunk(narrow))


def test_nothing_comes_of_nothing(make_info: MakeInfo) -> None:
    assert reception(make_info()).take([]) == []
