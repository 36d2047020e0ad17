"""From which number on a stamp can be of one unit only, and what float64 holds of it."""

import numpy as np
import pytest

from protocol.tables.clock import Clock, likely_units

#: 1990 and 2100.
FIRST, LAST = 631_152_000, 4_102_444_800


@pytest.mark.parametrize(("unit", "per_second"), [("ms", 10**3), ("us", 10**6), ("ns", 10**9)])
@pytest.mark.parametrize(
    ("year", "more", "since_1970"), [(FIRST, 0, True), (FIRST, -1, False), (LAST, -1, True), (LAST, 0, False)]
)
def test_stamps_since_1970_lie_between_1990_and_2100(
    unit: str, per_second: int, year: int, more: int, since_1970: bool
) -> None:
    stamps = np.array([per_second * (year + more)], dtype=np.int64)
    clock = Clock()
    seconds = clock.seconds(stamps)
    assert (clock.unit, clock.since_1970) == ((unit, True) if since_1970 else ("", False))
    if since_1970:
        assert clock.origin_s + seconds[0] == pytest.approx(year + more, rel=1e-12)


@pytest.mark.parametrize(
    ("step", "units"),
    [
        (0.02, []),
        (0.025, ["ms"]),  # 40 kHz
        (24.9, ["ms"]),
        (25.0, ["ms", "us"]),
        (200.0, ["ms", "us"]),  # 5 Hz
        (201.0, ["us"]),
        (24_900.0, ["us"]),
        (25_000.0, ["us", "ns"]),
        (200_000.0, ["us", "ns"]),
        (200_001.0, ["ns"]),
        (2e8, ["ns"]),
        (2.1e8, []),
    ],
)
def test_samples_come_from_5_to_40_000_times_a_second(step: float, units: list[str]) -> None:
    assert likely_units(step) == units


@pytest.mark.parametrize(
    ("steps", "unit"),
    [([1, 1, 1], ""), ([2, 2, 2], "ms"), ([2, 1, 1], ""), ([2, 2, 1], "ms"), ([500, 500, 500], "us")],
)
def test_whole_numbers_more_than_one_apart_are_no_seconds(steps: list[int], unit: str) -> None:
    clock = Clock()
    t = clock.seconds(np.cumsum([0, *steps]).astype(np.int64))
    assert (clock.unit, clock.since_1970) == (unit, False)
    assert t[1] == pytest.approx(steps[0] * {"": 1.0, "ms": 1e-3, "us": 1e-6}[unit])


def test_one_whole_number_tells_no_unit() -> None:
    clock = Clock()
    assert clock.seconds(np.array([1000], dtype=np.int64)).tolist() == [1000.0] and clock.unit == ""
    assert Clock().seconds(np.array([0.0, 10.0, 20.0])).tolist() == [0.0, 10.0, 20.0]  # of real numbers none


@pytest.mark.parametrize(
    ("first", "origin"),
    [(4_194_303_999_999_999, 0), (8_388_607_999_999_999, 0), (8_388_608_000_000_000, 8_388_608_000_000_000)],
)
def test_what_float64_holds_more_coarsely_than_a_nanosecond_is_counted_from_the_first(
    first: int, origin: int
) -> None:
    """From 2**23 s on float64 goes in steps of 1.9 ns."""
    clock = Clock(1e-9)
    t = clock.seconds(first + np.array([0, 10**9], dtype=np.int64))
    assert clock.origin == origin
    assert t.tolist() == pytest.approx([1e-9 * (first - origin), 1e-9 * (first - origin) + 1.0], rel=1e-15)


def test_what_is_said_of_a_unit_holds() -> None:
    clock = Clock(1e-3)
    assert clock.seconds(np.array([0, 20, 40], dtype=np.int64)).tolist() == pytest.approx([0.0, 0.02, 0.04])
    assert (clock.unit, clock.origin, clock.origin_s) == ("", 0, 0.0)
    assert clock.seconds(np.array([], dtype=np.int64)).tolist() == []


def test_the_first_block_that_has_rows_says_what_stamps_are() -> None:
    clock = Clock()
    assert clock.seconds(np.array([], dtype=np.int64)).tolist() == []
    assert clock.seconds(np.array([0, 1_000_000], dtype=np.int64)).tolist() == pytest.approx([0.0, 0.001])
    assert clock.seconds(np.array([2_000_000], dtype=np.int64)).tolist() == pytest.approx([0.002])
    unfinished = Clock()
    assert np.isnan(unfinished.seconds(np.array([np.nan, 1.0]))[0]) and unfinished.origin == 0
