"""Stamps of every kind as seconds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.tables.clock import Clock, likely_units

UNITS = {"ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}


@pytest.mark.parametrize("unit", UNITS)
def test_counts_since_1970_are_in_the_only_unit_they_can_be_in(unit):
    stamps = 1_700_000_000 * UNITS[unit] + np.arange(100, dtype=np.int64) * (UNITS[unit] // 100)
    for values in (stamps, stamps.astype(np.float64)):
        clock = Clock()
        assert np.allclose(clock.seconds(values), 0.01 * np.arange(100), atol=1e-6)
        assert clock.unit == unit and clock.since_1970 and clock.origin_s == pytest.approx(1.7e9)


def test_seconds_stay_seconds():
    for t in (0.01 * np.arange(100), 1.7e9 + 0.01 * np.arange(100), 1000.0 * np.arange(100)):
        clock = Clock()
        assert np.array_equal(clock.seconds(t), t) and not clock.unit and not clock.origin


@pytest.mark.parametrize(("step", "unit"), [(1_000_000, "ns"), (1000, "us"), (10, "ms"), (20, "ms")])
def test_whole_numbers_too_far_apart_for_seconds(step, unit):
    clock = Clock()
    t = clock.seconds(step * np.arange(100, dtype=np.int64))
    assert clock.unit == unit and not clock.since_1970
    assert np.allclose(t, step / UNITS[unit] * np.arange(100))


def test_what_may_be_either_stays_as_it_is():
    assert likely_units(100.0) == ["ms", "us"]
    stamps = 100 * np.arange(100, dtype=np.int64)
    assert np.array_equal(Clock().seconds(stamps), stamps)


@given(first=st.integers(0, 2**62), step=st.integers(1, 10**9), n=st.integers(2, 50), size=st.integers(1, 20))
def test_blocks_go_on_from_one_another_and_keep_their_nanoseconds(first, step, n, size):
    stamps = first + step * np.arange(n, dtype=np.int64)
    whole, parts = Clock(1e-9), Clock(1e-9)
    t = whole.seconds(stamps)
    together = np.concatenate([parts.seconds(stamps[k : k + size]) for k in range(0, n, size)])
    assert np.array_equal(t, together)
    assert np.allclose(np.diff(t), 1e-9 * step, rtol=0, atol=2e-9)


@pytest.mark.parametrize(
    ("step", "units"),
    [
        *((0.024, []), (0.025, ["ms"]), (200.0, ["ms", "us"]), (201.0, ["us"]), (24.0, ["ms"])),
        *((25.0, ["ms", "us"]), (200_000.0, ["us", "ns"]), (200_001.0, ["ns"]), (24_999.0, ["us"])),
        *((2e8, ["ns"]), (2.01e8, [])),
    ],
)
def test_rates_are_of_5_hz_to_40_khz(step, units):
    assert likely_units(step) == units


def test_stamps_that_a_float_holds_are_not_counted_anew():
    """Up to 2^23 s it does so to a nanosecond."""
    for first, origin in ((8_388_607_000, 0), (8_388_609_000, 8_388_609_000)):
        clock = Clock(1e-3)
        t = clock.seconds(first + np.arange(3, dtype=np.int64))
        assert clock.origin == origin and t[1] - t[0] == pytest.approx(1e-3, abs=2e-9)
        assert clock.origin_s == pytest.approx(1e-3 * origin)


def test_a_single_stamp_and_none_tell_no_unit():
    assert Clock().seconds(np.empty(0)).tolist() == []
    clock = Clock()
    assert clock.seconds(np.array([1_000_000])).tolist() == [1e6] and not clock.unit
    assert Clock().seconds(np.array([0, 1, 2])).tolist() == [0.0, 1.0, 2.0]  # a second apart: seconds
    assert np.isnan(Clock().seconds(np.array([np.nan, 1.0]))[0])


LARGE = [(2**63 + 5, np.uint64), (2**64 - 4000, np.uint64), (-(2**62), np.int64)]


@pytest.mark.parametrize(("first", "kind"), LARGE)
def test_stamps_of_all_of_64_bits_are_counted_from_the_first(first: int, kind: type[np.integer]):
    stamps = np.array([first + 1000 * k for k in range(4)], dtype=kind)
    clock = Clock()
    np.testing.assert_allclose(np.diff(clock.seconds(stamps)), 1e-3)
    assert clock.origin == first and clock.unit == "us"


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
    ("steps", "unit"),
    [([1, 1, 1], ""), ([2, 2, 2], "ms"), ([2, 1, 1], ""), ([2, 2, 1], "ms"), ([500, 500, 500], "us")],
)
def test_whole_numbers_more_than_one_apart_are_no_seconds(steps: list[int], unit: str) -> None:
    clock = Clock()
    t = clock.seconds(np.cumsum([0, *steps]).astype(np.int64))
    assert (clock.unit, clock.since_1970) == (unit, False)
    assert t[1] == pytest.approx(steps[0] * {"": 1.0, "ms": 1e-3, "us": 1e-6}[unit])


def test_the_first_block_that_has_rows_says_what_stamps_are() -> None:
    clock = Clock()
    assert clock.seconds(np.array([], dtype=np.int64)).tolist() == []
    assert clock.seconds(np.array([0, 1_000_000], dtype=np.int64)).tolist() == pytest.approx([0.0, 0.001])
    assert clock.seconds(np.array([2_000_000], dtype=np.int64)).tolist() == pytest.approx([0.002])
    unfinished = Clock()
    assert np.isnan(unfinished.seconds(np.array([np.nan, 1.0]))[0]) and unfinished.origin == 0
