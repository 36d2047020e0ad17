"""The pieces of the line of stamps, by hand."""

import pytest

from daemon.clock.stamp_line import StampLine


def stamped(at_s: float, rate: float = 1.0) -> StampLine:
    line = StampLine(rate)
    line.stamp(at_s)
    return line


@pytest.mark.parametrize(
    ("offset_s", "away_s", "at_s"),
    [(0.02, 0.02, 1.002), (-0.02, 0.02, 0.998), (0.5, 0.5, 1.01), (-0.5, 0.5, 0.99), (0.1, 0.1, 1.01)],
)
def test_what_is_missing_is_made_up_for_in_ten_seconds_or_by_a_hundredth(
    offset_s: float, away_s: float, at_s: float
) -> None:
    line = stamped(0.0)
    assert line.approach(1.0, offset_s) == pytest.approx(away_s)
    assert line.at(1.0) == pytest.approx(at_s) and line.at(0.0) == 0.0


def test_the_line_to_come_begins_where_was_stamped_last() -> None:
    line = stamped(2.0)
    assert line.stamp(1.0) == 1.0  # of before; the last one is still that at 2
    assert line.approach(1.5, -1.0) == 0.0
    assert [line.at(at_s) for at_s in (1.0, 2.0, 4.0)] == [1.0, 2.0, 5.0]


def test_times_before_the_first_piece_are_on_it() -> None:
    line = StampLine(0.5)
    assert [line.at(at_s) for at_s in (-2.0, 0.0, 2.0)] == [-1.0, 0.0, 1.0]


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
    line = stamped(2.0)
    line.hold_back(3.0, most_s)
    assert (line.at(3.0), line.at(4.0)) == pytest.approx(then)
    assert line.at(2.0) == 2.0


def test_what_waits_goes_on_by_a_share_of_its_rate() -> None:
    line = stamped(2.0, 1.2)
    line.hold_back(3.0, 0.0)
    assert (line.at(2.0), line.at(3.0), line.at(4.0)) == pytest.approx((2.4, 3.0, 4.2))


@pytest.mark.parametrize("at_s", [1.0, 2.0])
def test_what_was_stamped_is_held_back_no_more(at_s: float) -> None:
    line = stamped(2.0)
    line.hold_back(at_s, 0.0)
    assert (line.at(at_s), line.at(3.0)) == (at_s, 3.0)


def test_before_anything_was_stamped_the_whole_line_is_moved() -> None:
    line = StampLine(1.0)
    line.hold_back(2.0, 1.5)
    assert (line.at(0.0), line.at(2.0)) == (-0.5, 1.5)
    line.catch_up(0.25)
    assert (line.at(0.0), line.at(2.0)) == (-0.25, 1.75)


def test_what_was_not_stamped_is_later_at_once() -> None:
    line = stamped(2.0, 1.5)
    line.catch_up(0.25)
    assert line.at(2.0) == 3.0
    assert (line.at(2.001), line.at(3.0)) == pytest.approx((3.2515, 4.75))


def test_a_newer_line_takes_the_place_of_one_that_nobody_asked() -> None:
    line = stamped(1.0)
    line.hold_back(3.0, 2.2)
    line.approach(1.0, 0.0)
    assert [line.at(at_s) for at_s in (1.0, 2.0, 3.0, 4.0)] == pytest.approx([1.0, 2.0, 3.0, 4.0])
