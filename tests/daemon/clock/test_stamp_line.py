"""Stamps never go back and never change, whatever the line is turned to."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.clock.stamp_line import StampLine


@given(
    st.lists(
        st.tuples(st.floats(0.001, 1.0), st.floats(0.8, 1.25), st.floats(-0.5, 0.5), st.floats(-0.1, 0.1)),
        min_size=1,
        max_size=40,
    )
)
def test_what_was_stamped_stays_and_time_goes_on(turns: list[tuple[float, float, float, float]]) -> None:
    line, now_s, stamped = StampLine(1.0), 0.0, [(-1.0, -100.0)]
    for step_s, rate, offset_s, late_s in turns:
        now_s += step_s
        line.hold_back(now_s, now_s + late_s)
        line.approach(rate, offset_s)
        for at_s in (now_s - 0.5 * step_s, now_s):
            if at_s > stamped[-1][0]:
                stamped.append((at_s, line.stamp(at_s)))
                assert stamped[-1][1] > stamped[-2][1]
    assert [line.at(at_s) for at_s, _ in stamped[1:]] == pytest.approx([host_s for _, host_s in stamped[1:]])


def test_before_anything_is_stamped_the_best_line_is_taken_at_once() -> None:
    line = StampLine(1.0)
    assert line.approach(0.96, 0.25) == 0.0
    assert line.stamp(10.0) == pytest.approx(0.25 + 9.6)


def test_a_better_line_is_approached() -> None:
    line = StampLine(1.0)
    line.stamp(0.0)
    for k in range(1, 401):
        line.approach(1.0, 0.02)
        line.stamp(0.1 * k)
    assert line.at(40.0) == pytest.approx(40.02, abs=0.02 * 0.02)  # four time constants


@pytest.mark.parametrize(
    ("offset_s", "rate"), [(1.0, 1.01), (0.11, 1.01), (0.02, 1.002), (-0.02, 0.998), (-0.11, 0.99), (-1.0, 0.99)]
)
def test_a_line_is_approached_in_ten_seconds_by_a_hundredth_at_most(offset_s: float, rate: float) -> None:
    line = StampLine(1.0)
    line.stamp(2.0)
    assert line.approach(1.0, offset_s) == pytest.approx(abs(offset_s))
    assert line.at(3.0) - 2.0 == pytest.approx(rate)
    assert (line.at(-1.0), line.at(1.0)) == pytest.approx((-1.0, 1.0))


def test_what_was_stamped_is_neither_held_back_nor_caught_up() -> None:
    line = StampLine(2.0)
    line.stamp(1.0)
    line.stamp(0.5)
    line.hold_back(1.0, 0.0)
    assert line.at(3.0) == 6.0
    line.catch_up(0.25)
    assert (line.at(0.5), line.at(1.0)) == (1.0, 2.0)
    assert line.at(3.0) == pytest.approx(6.25)


def stamped_until(at_s: float, rate: float = 1.0) -> StampLine:
    line = StampLine(rate)
    line.stamp(at_s)
    return line


def test_the_line_to_come_begins_where_was_stamped_last() -> None:
    line = stamped_until(2.0)
    assert line.stamp(1.0) == 1.0  # of before; the last one is still that at 2
    assert line.approach(1.5, -1.0) == 0.0
    assert [line.at(at_s) for at_s in (1.0, 2.0, 4.0)] == [1.0, 2.0, 5.0]


def test_each_time_lies_on_its_own_piece() -> None:
    line = StampLine(1.0)
    for at_s, rate in ((1.0, 2.0), (2.0, 3.0), (3.0, 1.0)):
        line.stamp(at_s)
        line.approach(rate, line.at(at_s) - rate * at_s)
    assert [line.at(at_s) for at_s in (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)] == pytest.approx(
        [0.5, 1.0, 2.0, 3.0, 4.5, 6.0, 7.0]
    )


@pytest.mark.parametrize(
    ("most_s", "then"), [(3.0, (3.0, 4.0)), (2.999, (2.999, 3.999)), (2.6, (2.6, 3.6)), (2.0, (2.5, 3.5))]
)
def test_stamps_wait_at_half_their_rate_at_the_most(most_s: float, then: tuple[float, float]) -> None:
    line = stamped_until(2.0)
    line.hold_back(3.0, most_s)
    assert (line.at(3.0), line.at(4.0)) == pytest.approx(then)
    assert line.at(2.0) == 2.0


def test_what_waits_goes_on_by_a_share_of_its_rate() -> None:
    line = stamped_until(2.0, 1.2)
    line.hold_back(3.0, 0.0)
    assert (line.at(2.0), line.at(3.0), line.at(4.0)) == pytest.approx((2.4, 3.0, 4.2))


def test_before_anything_was_stamped_the_whole_line_is_moved() -> None:
    line = StampLine(1.0)
    line.hold_back(2.0, 1.5)
    assert (line.at(0.0), line.at(2.0)) == (-0.5, 1.5)
    line.catch_up(0.25)
    assert (line.at(0.0), line.at(2.0)) == (-0.25, 1.75)


def test_a_newer_line_takes_the_place_of_one_that_nobody_asked() -> None:
    line = stamped_until(1.0)
    line.hold_back(3.0, 2.2)
    line.approach(1.0, 0.0)
    assert [line.at(at_s) for at_s in (1.0, 2.0, 3.0, 4.0)] == pytest.approx([1.0, 2.0, 3.0, 4.0])
