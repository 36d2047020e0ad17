"""Whatever disorder a line makes within a few frames, frames leave in order and once."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.reception.sequencer import Sequencer
from protocol.serial_frame import InfoFrame, SamplesFrame, SamplesRun
from tests.daemon.conftest import device_info

COUNTS = np.zeros((32, 12), dtype=np.int16)


def frames(n: int, first: int = 0, ticks: int = 0) -> list[SamplesFrame]:
    return [SamplesFrame((first + k) % 2**32, ticks + 1000 * k, COUNTS) for k in range(n)]


def through(sequencer: Sequencer, some: list[SamplesFrame]) -> list[int]:
    out = [frame.sequence for one in some for frame in sequencer.put(one)]
    return out + [frame.sequence for frame in sequencer.release()]


@given(st.data(), st.sampled_from([0, 2**32 - 6]))
def test_frames_that_overtake_others_leave_in_order(data: st.DataObject, first: int) -> None:
    some = frames(20, first)
    order = sorted(range(20), key=lambda k: k + data.draw(st.floats(0.0, 3.9)))
    order.remove(0)
    sequencer = Sequencer()
    assert through(sequencer, [some[k] for k in [0, *order]]) == [one.sequence for one in some]
    assert (sequencer.doubled, sequencer.late) == (0, 0)


@given(st.lists(st.integers(0, 19), max_size=10), st.integers(0, 5))
def test_what_comes_twice_leaves_once(twice: list[int], after: int) -> None:
    some, stream = frames(20), []
    for k, one in enumerate(some):
        stream += [one, *(some[j] for j in twice if j + after == k)]
    stream += [some[j] for j in twice if j + after >= 20]
    sequencer = Sequencer()
    assert through(sequencer, stream) == list(range(20))
    assert sequencer.doubled == len(twice)


def test_what_never_comes_is_given_up_after_a_few_frames() -> None:
    some, sequencer = frames(10), Sequencer()
    left = [[frame.sequence for frame in sequencer.put(one)] for one in some if one.sequence != 2]
    assert left == [[0], [1], [], [], [], [], [3, 4, 5, 6, 7], [8], [9]]
    assert sequencer.put(some[2]) == []
    assert sequencer.late == 1


def test_a_device_that_counts_anew_is_believed() -> None:
    sequencer = Sequencer()
    assert through(sequencer, [*frames(30, 1000, 10**9), *frames(5)]) == [*range(1000, 1030), *range(5)]
    again = Sequencer()  # and so is one that had hardly begun
    assert through(again, [*frames(30, 0, 10**9), *frames(5)]) == [*range(30), *range(5)]
    assert again.doubled == again.late == 0


def test_much_that_was_lost_holds_nothing_back() -> None:
    assert through(Sequencer(), [*frames(3), *frames(3, 500, 10**6)]) == [0, 1, 2, 500, 501, 502]


@given(st.lists(st.tuples(st.integers(0, 30), st.integers(1, 6)), max_size=12), st.sampled_from([0, 2**32 - 9]))
def test_runs_leave_as_their_frames_would(runs: list[tuple[int, int]], first: int) -> None:
    whole, single = Sequencer(), Sequencer()
    for begin, n in runs:
        ticks = [1000 * (begin + k) for k in range(n)]
        run = SamplesRun((first + begin) % 2**32, ticks, np.zeros((32 * n, 12), dtype=np.int16))
        left: list[SamplesFrame] = []
        for one in whole.take(run):
            left += one.frames() if isinstance(one, SamplesRun) else [one]
        expected = [one for frame in run.frames() for one in single.put(frame)]
        assert [(one.sequence, one.ticks) for one in left] == [(one.sequence, one.ticks) for one in expected]
    assert (whole.doubled, whole.late, whole.waiting) == (single.doubled, single.late, single.waiting)


def test_a_copy_of_any_frame_that_had_waited_is_known() -> None:
    some, sequencer = frames(5), Sequencer()
    for k in (0, 2, 3, 4, 1):  # those from 2 on wait for 1
        last = [frame.sequence for frame in sequencer.put(some[k])]
    assert last == [1, 2, 3, 4]
    assert [sequencer.put(one) for one in some] == [[]] * 5
    assert (sequencer.doubled, sequencer.late) == (5, 0)


def numbered(number: int, ticks: int | None = None) -> SamplesFrame:
    return SamplesFrame(number % 2**32, 1000 * number if ticks is None else ticks, COUNTS)


def after(last: int, first: int = 0) -> Sequencer:
    """Return a sequencer that frames have passed in order."""
    sequencer = Sequencer()
    for number in range(first, last + 1):
        assert [one.ticks for one in sequencer.put(numbered(number))] == [1000 * number]
    return sequencer


def left(sequencer: Sequencer, *some: SamplesFrame) -> list[int]:
    return [one.sequence for given in some for one in sequencer.put(given)]


@pytest.mark.parametrize(
    ("ticks", "is_late"), [(4_000_000, True), (3_001_000, True), (3_000_000, True), (2_999_999, False)]
)
def test_a_frame_that_was_given_up_is_no_older_than_those_before_it(ticks: int, is_late: bool) -> None:
    sequencer = after(3000, 2990)
    sequencer.put(numbered(3002))
    sequencer.release()
    assert left(sequencer, numbered(3001, ticks)) == ([] if is_late else [3001])
    assert sequencer.late == is_late


@pytest.mark.parametrize(("ticks", "doubled"), [(5_000, 1), (5_001, 0)])
def test_a_number_that_comes_again_is_the_same_frame_if_its_clock_is(ticks: int, doubled: int) -> None:
    sequencer = after(9)
    assert left(sequencer, numbered(5, ticks)) == ([] if doubled else [5])
    assert (sequencer.doubled, sequencer.late) == (doubled, 0)


def test_what_waits_leaves_before_a_frame_far_away() -> None:
    sequencer = after(3)
    assert left(sequencer, numbered(6), numbered(500)) == [6, 500]
    assert left(sequencer, numbered(501)) == [501]


def test_a_run_in_its_turn_leaves_whole_and_is_known_afterwards() -> None:
    sequencer = after(3)
    run = SamplesRun(4, [4000, 5000, 6000], np.zeros((12, 3), dtype=np.int16))
    assert sequencer.take(run) == [run]
    assert left(sequencer, numbered(5), numbered(7)) == [7] and sequencer.doubled == 1
    info = InfoFrame(8, 8000, device_info())
    assert sequencer.take(info) == [info]
