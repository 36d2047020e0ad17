"""What is damaged on the line is distinguished from what never came."""

import numpy as np
import pytest

from daemon.reception.loss_attribution import LossAttribution
from protocol.serial_frame import SamplesFrame
from protocol.serial_parser import ParserCounters

FRAME = SamplesFrame(0, 0, np.zeros((32, 12), dtype=np.int16))
FRAME_BYTES = 24 + 2 * 32 * 12 + 4


def looked(*steps: tuple[int, int], good: int = 1) -> LossAttribution:
    """Return the damage after looks that found a good frame, a number of damaged ones, and bytes of no frame."""
    counters = ParserCounters()
    damage = LossAttribution(counters)
    for frames, wasted in steps:
        counters.frames += good
        counters.crc_errors += frames
        counters.discarded_bytes += wasted
        damage.look()
    return damage


def test_a_damaged_frame_explains_one_gap_and_no_other() -> None:
    damage = looked((1, FRAME_BYTES))
    assert damage.explains(32, FRAME)
    assert not damage.explains(32, FRAME)


def test_as_many_damaged_frames_as_are_missing_are_used_up() -> None:
    damage = looked((1, FRAME_BYTES), (2, 2 * FRAME_BYTES))
    assert damage.explains(64, FRAME) and damage.explains(32, FRAME)
    assert not damage.explains(32, FRAME)


def test_where_no_frame_can_be_known_its_bytes_count() -> None:
    assert looked((0, 10 * FRAME_BYTES)).explains(10 * 32, FRAME)
    assert not looked((0, FRAME_BYTES)).explains(10 * 32, FRAME)


def test_a_mostly_lost_frame_explains_its_whole_gap() -> None:
    assert looked((1, 100)).explains(5 * 32, FRAME)


def test_garbage_does_not_pass_for_frames_that_never_came() -> None:
    assert not looked(*[(0, 20)] * 15).explains(32, FRAME)


def test_damage_of_long_ago_explains_nothing() -> None:
    assert looked((1, FRAME_BYTES), *[(0, 0)] * 15).explains(32, FRAME)
    assert not looked((1, FRAME_BYTES), *[(0, 0)] * 16).explains(32, FRAME)


def test_while_no_good_frame_comes_nothing_is_long_ago() -> None:
    assert looked(*[(0, FRAME_BYTES)] * 90, good=0).explains(90 * 32, FRAME)


def test_what_is_forgotten_explains_nothing() -> None:
    damage = looked((1, FRAME_BYTES))
    damage.forget()
    damage.look()
    assert not damage.explains(32, FRAME)


@pytest.mark.parametrize(
    ("wasted", "lost", "explained"),
    [
        (FRAME_BYTES // 2, 1, True),  # half of a frame
        (FRAME_BYTES // 2 - 1, 1, False),
        (FRAME_BYTES // 2, 32, True),
        (FRAME_BYTES, 33, True),  # half of two
        (FRAME_BYTES - 1, 33, False),
        (FRAME_BYTES - 1, 32, True),
    ],
)
def test_bytes_of_no_frame_explain_twice_as_many(wasted: int, lost: int, explained: bool) -> None:
    assert looked((0, wasted)).explains(lost, FRAME) == explained


def test_bytes_that_explain_a_gap_are_used_up_from_the_oldest_on() -> None:
    damage = looked((0, 500), (0, 500), (0, 0))
    assert damage.explains(32, FRAME)
    assert not damage.explains(32, FRAME)  # 204 are left
    two = looked((0, 2 * FRAME_BYTES))
    assert [two.explains(32, FRAME) for _ in range(3)] == [True, True, False]


def test_a_gap_takes_no_more_bytes_than_it_is_long_wherever_they_are() -> None:
    damage = looked((0, FRAME_BYTES // 2), (0, FRAME_BYTES), (0, FRAME_BYTES // 2))  # two frames' in all
    assert damage.explains(32, FRAME)
    assert damage.explains(32, FRAME)
    assert not damage.explains(32, FRAME)


def test_frames_that_are_malformed_count_as_damaged_ones() -> None:
    counters = ParserCounters()
    counters.frames = counters.crc_errors = counters.discarded_bytes = 7
    damage = LossAttribution(counters)
    damage.look()
    assert not damage.explains(32, FRAME)  # that was before
    counters.malformed += 1
    damage.look()
    assert damage.explains(32, FRAME)


def test_what_has_happened_is_the_cause_before_all_else() -> None:
    damage = looked((1, FRAME_BYTES))
    damage.why = "unplugged"
    assert damage.cause(32, FRAME, lambda _frame: True) == "unplugged"
    damage.why = None
    assert damage.cause(32, FRAME, lambda _frame: True) == "lost in the device"
    assert damage.cause(32, FRAME, lambda _frame: False) == "damaged on the line"
    assert damage.cause(32, FRAME, lambda _frame: False) == "frames missing"  # that damage is used up
