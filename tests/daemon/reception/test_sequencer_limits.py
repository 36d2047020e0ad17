"""How far a frame's number may be off and still be disorder on the line."""

import numpy as np
import pytest

from daemon.reception.sequencer import Sequencer
from protocol.serial_frame import InfoFrame, SamplesFrame, SamplesRun
from tests.daemon.conftest import device_info

COUNTS = np.zeros((4, 3), dtype=np.int16)
WRAP = 2**32


def frame(number: int, ticks: int | None = None) -> SamplesFrame:
    return SamplesFrame(number % WRAP, 1000 * number if ticks is None else ticks, COUNTS)


def after(last: int, first: int = 0) -> Sequencer:
    """Return a sequencer that frames have passed in order."""
    sequencer = Sequencer()
    for number in range(first, last + 1):
        assert [one.ticks for one in sequencer.put(frame(number))] == [1000 * number]
    return sequencer


def left(sequencer: Sequencer, *some: SamplesFrame) -> list[int]:
    return [one.sequence for given in some for one in sequencer.put(given)]


@pytest.mark.parametrize("first", [0, WRAP - 3])
@pytest.mark.parametrize(("ahead", "waits"), [(0, False), (1, True), (64, True), (65, False)])
def test_a_frame_waits_for_sixty_four_before_it(first: int, ahead: int, waits: bool) -> None:
    sequencer = after(first + 2, first)
    number = first + 3 + ahead
    assert left(sequencer, frame(number)) == ([] if waits else [number % WRAP])
    assert sequencer.waiting == waits


@pytest.mark.parametrize(("behind", "is_late"), [(2, True), (64, True), (65, False)])
def test_a_frame_is_late_by_sixty_four_at_the_most(behind: int, is_late: bool) -> None:
    sequencer = after(200, 100)
    sequencer.put(frame(300))  # 99 are given up
    number = 301 - behind
    assert left(sequencer, frame(number, 1000 * number)) == ([] if is_late else [number])
    assert (sequencer.late, sequencer.doubled) == (is_late, 0)


@pytest.mark.parametrize(
    ("ticks", "is_late"), [(4_000_000, True), (3_001_000, True), (3_000_000, True), (2_999_999, False)]
)
def test_a_frame_that_was_given_up_is_no_older_than_those_before_it(ticks: int, is_late: bool) -> None:
    sequencer = after(3000, 2990)
    sequencer.put(frame(3002))
    sequencer.release()
    assert left(sequencer, frame(3001, ticks)) == ([] if is_late else [3001])
    assert sequencer.late == is_late


@pytest.mark.parametrize(("ticks", "doubled"), [(5_000, 1), (5_001, 0)])
def test_a_number_that_comes_again_is_the_same_frame_if_its_clock_is(ticks: int, doubled: int) -> None:
    sequencer = after(9)
    assert left(sequencer, frame(5, ticks)) == ([] if doubled else [5])
    assert (sequencer.doubled, sequencer.late) == (doubled, 0)


def test_a_frame_that_waits_and_comes_again_is_doubled() -> None:
    sequencer = after(3)
    assert left(sequencer, frame(6), frame(6), frame(6), frame(4)) == [4]
    assert (sequencer.doubled, sequencer.waiting) == (2, 1)
    assert left(sequencer, frame(5)) == [5, 6]
    assert sequencer.waiting == 0


@pytest.mark.parametrize("first", [0, WRAP - 4])
def test_the_fifth_frame_that_waits_gives_up_what_is_before_them(first: int) -> None:
    sequencer = after(first + 1, first)
    numbers = [first + k for k in (8, 5, 4, 7)]
    assert left(sequencer, *(frame(number) for number in numbers)) == [] and sequencer.waiting == 4
    assert left(sequencer, frame(first + 10)) == [(first + k) % WRAP for k in (4, 5)]
    assert sequencer.waiting == 3
    assert [one.sequence for one in sequencer.release()] == [(first + k) % WRAP for k in (7, 8, 10)]


def test_the_first_frame_has_any_number() -> None:
    sequencer = Sequencer()
    assert left(sequencer, frame(WRAP - 1), frame(WRAP)) == [WRAP - 1, 0]


def test_what_waits_leaves_before_a_frame_far_away() -> None:
    sequencer = after(3)
    assert left(sequencer, frame(6), frame(500)) == [6, 500]
    assert left(sequencer, frame(501)) == [501]


def test_a_run_in_its_turn_leaves_whole_and_is_known_afterwards() -> None:
    sequencer = after(3)
    run = SamplesRun(4, [4000, 5000, 6000], np.zeros((12, 3), dtype=np.int16))
    assert sequencer.take(run) == [run]
    assert left(sequencer, frame(5), frame(7)) == [7] and sequencer.doubled == 1
    info = InfoFrame(8, 8000, device_info())
    assert sequencer.take(info) == [info]


def test_a_run_out_of_turn_leaves_frame_by_frame() -> None:
    sequencer = after(3)
    late = SamplesRun(5, [5000, 6000], np.zeros((8, 3), dtype=np.int16))
    assert sequencer.take(late) == []
    found = sequencer.take(SamplesRun(4, [4000], COUNTS))
    assert [one.sequence for one in found] == [4, 5, 6]


def test_frames_that_waited_are_known_by_clocks_of_their_own() -> None:
    sequencer = after(2)
    assert left(sequencer, *(frame(number) for number in (4, 5, 6, 3))) == [3, 4, 5, 6]
    assert left(sequencer, *(frame(number) for number in (4, 5, 6))) == []
    assert sequencer.doubled == 3
