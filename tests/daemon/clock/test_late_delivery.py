"""By how much stamps are in doubt that late arrivals have moved."""

import pytest

from daemon.clock.late_delivery import LateDelivery


def moved() -> LateDelivery:
    late = LateDelivery()
    late.on_time(10.0, 110.0, 1.5, 0.0)
    late.moved(11.0)
    return late


def test_nothing_is_in_doubt_before_stamps_were_moved() -> None:
    assert LateDelivery().error_s(10.0, 5.0) == 0.0


@pytest.mark.parametrize(("stamped_s", "error_s"), [(117.0, 1.0), (116.0, 0.0), (115.0, 1.0)])
def test_the_distance_from_the_line_before_is_in_doubt(stamped_s: float, error_s: float) -> None:
    assert moved().error_s(14.0, stamped_s) == pytest.approx(error_s)


def test_the_line_before_is_that_of_the_first_of_several_moves() -> None:
    late = moved()
    late.on_time(12.0, 114.0, 1.0, 0.0)
    late.moved(12.5)
    assert late.error_s(14.0, 120.0) == pytest.approx(4.0)


def test_no_delivery_is_late_for_longer_than_half_a_minute() -> None:
    late = moved()
    assert late.error_s(40.9, 200.0) > 0.0
    late.moved(40.9)  # moved again, it goes on
    assert late.error_s(70.8, 300.0) == pytest.approx(300.0 - 110.0 - 1.5 * 60.8)
    assert late.error_s(70.9, 300.0) == 0.0
    late.on_time(80.0, 400.0, 1.0, 0.0)
    late.moved(80.5)
    assert late.error_s(81.0, 402.0) == pytest.approx(1.0)


def test_one_that_is_over_is_not_taken_up_again() -> None:
    late = moved()
    late.on_time(50.0, 300.0, 1.0, 0.0)
    late.moved(50.0)
    assert late.error_s(51.0, 301.0) == pytest.approx(0.0)


def test_what_is_not_known_of_the_rate_adds_to_it() -> None:
    late = LateDelivery()
    late.on_time(10.0, 110.0, 1.0, 1e-3)
    late.moved(10.5)
    assert late.error_s(20.0, 121.0) == pytest.approx(1.01)
    assert late.error_s(20.0, 119.0) == pytest.approx(1.01)
