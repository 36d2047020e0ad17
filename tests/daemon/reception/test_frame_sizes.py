"""Between which bounds the samples lie of frames that never came."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.reception.frame_sizes import FrameSizes


def seen(*samples: int) -> FrameSizes:
    sizes = FrameSizes()
    for n in samples:
        sizes = sizes.with_frame(n)
    return sizes


def test_the_smallest_and_the_largest_are_kept() -> None:
    assert (seen(32, 8, 40, 24).smallest, seen(32, 8, 40, 24).largest) == (8, 40)
    assert seen(32, 32).are_one and seen(7).are_one and not seen(32, 31).are_one


@pytest.mark.parametrize(
    ("by_clock", "nearest"), [(-5.0, 48), (47.9, 48), (48.0, 48), (60.25, 60.25), (80.0, 80), (81.0, 80)]
)
def test_a_clock_is_as_near_as_frames_allow(by_clock: float, nearest: float) -> None:
    assert seen(24, 40).nearest(2, by_clock) == nearest
    assert seen(24, 40).nearest(0, by_clock) == 0


@pytest.mark.parametrize(
    ("frames", "samples", "infos"),
    [(3, 96, 0), (3, 64, 1), (3, 0, 3), (3, 80, None), (3, 128, None), (0, 0, 0), (0, 32, None)],
)
def test_infos_among_frames_of_one_size_are_known(frames: int, samples: int, infos: int | None) -> None:
    assert seen(32).without_samples(frames, samples) == infos


@given(st.lists(st.integers(0, 60), max_size=8), st.integers(1, 60), st.integers(1, 60))
def test_no_more_infos_are_told_than_there_may_be(lost: list[int], one: int, other: int) -> None:
    sizes = seen(one, other, *(n for n in lost if n))
    infos = sizes.without_samples(len(lost), sum(lost))
    assert infos is not None and infos <= lost.count(0)
    assert sizes.nearest(len(lost) - lost.count(0), sum(lost)) == sum(lost)
