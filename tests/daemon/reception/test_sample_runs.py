"""Counts of frames that follow each other become runs, with times that are asked for later."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from daemon.reception.channel_watch import ChannelWatch
from daemon.reception.sample_runs import CountedRuns, FrameTimes
from tests.daemon.conftest import device_info


class Clock:
    """A microsecond a tick, from a billion on; and a step that says at which tick it was asked for."""

    def utc_ns(self, ticks: int) -> int:
        return 10**9 + 1000 * ticks

    def dt_s(self, ticks: int) -> float:
        return 1e-6 * ticks


def times(sample0: int, n_frame: int, frame_samples: int = 32) -> FrameTimes:
    clock: Any = Clock()
    return FrameTimes(sample0, frame_samples, [4000 * k for k in range(n_frame)], clock, clock)


@pytest.mark.parametrize(
    ("sample", "frame"), [(100, 0), (131, 0), (132, 1), (195, 2), (196, 3), (227, 3), (228, 3), (9999, 3)]
)
def test_a_sample_s_time_is_that_of_its_frame(sample: int, frame: int) -> None:
    stamp = times(100, 4).before(sample)
    assert stamp == (100 + 32 * frame, 10**9 + 4_000_000 * frame, pytest.approx(4e-3 * frame))


def test_frames_that_go_on_are_one_run_and_a_loss_begins_another() -> None:
    info = device_info()
    channels = tuple(replace(one, scale=0.5 + k, offset=2.0 * k) for k, one in enumerate(info.channels))
    runs = CountedRuns(ChannelWatch(channels, info.rate_hz))
    counts = np.arange(5 * 4 * 12, dtype=np.int16).reshape(5, 4, 12)
    runs.add(times(0, 1, 4), counts[0])
    runs.add(times(4, 1, 4), counts[1])
    runs.add(times(18, 1, 4), counts[2], lost=10)
    runs.add(times(22, 1, 4), counts[3])
    one, two = runs.take()
    assert [(run.lost, run.sample0, len(run.a), len(run.times)) for run in (one, two)] == [
        (0, 0, 8, 2),
        (10, 18, 8, 2),
    ]
    scale, offset = 0.5 + np.arange(12), 2.0 * np.arange(12)
    np.testing.assert_allclose(one.a, counts[:2].reshape(8, 12) * scale + offset)
    np.testing.assert_allclose(two.a, counts[2:4].reshape(8, 12) * scale + offset)
    assert [one.sample0 for one in two.times] == [18, 22]
    assert runs.take() == []
    runs.add(times(26, 1, 4), counts[4])
    (three,) = runs.take()
    assert (three.lost, three.sample0, len(three.a)) == (0, 26, 4)


def test_all_that_is_taken_is_watched() -> None:
    info = device_info()
    watch = ChannelWatch(info.channels, info.rate_hz)
    runs = CountedRuns(watch)
    runs.add(times(0, 1), np.full((32, 12), 7, dtype=np.int16))
    runs.add(times(64, 1), np.full((32, 12), 7, dtype=np.int16), lost=32)
    assert watch.take().samples == 0
    runs.take()
    assert watch.take().samples == 64
