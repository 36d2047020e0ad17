"""Frames wait for a majority, and never for long."""

import numpy as np

from daemon.clock.tick_step import MAJORITY
from daemon.reception.doubted_frames import DoubtedFrames
from protocol.serial_frame import SEQUENCES, SamplesFrame

COUNTS = np.zeros((1, 3), dtype=np.int16)


def test_as_many_as_make_a_majority_are_enough() -> None:
    doubted, first = DoubtedFrames(), SEQUENCES - 2
    assert not doubted
    for k in range(MAJORITY + 1):
        assert not doubted.enough
        doubted.put(SamplesFrame((first + k) % SEQUENCES, k, COUNTS))
    assert doubted and doubted.enough
    assert [frame.ticks for frame in doubted.take()] == list(range(MAJORITY + 1))
    assert not doubted


def test_frames_that_never_follow_each_other_wait_no_longer() -> None:
    doubted = DoubtedFrames()
    for k in range(4 * MAJORITY):
        assert not doubted.enough
        doubted.put(SamplesFrame(2 * k, k, COUNTS))
    assert doubted.enough
