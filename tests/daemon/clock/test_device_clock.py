"""Stamps follow the device's clock, never go back, and their rate is found in spite of all delays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.clock.device_clock import ClockState, DeviceClock

TICK_HZ = 1e6
UTC_NS = 1_700_000_000_000_000_000
START_NS = 5_000_000_000


def stream(clock: DeviceClock, ppm: float, seconds: float, delay: np.ndarray, step_s: float = 0.01) -> np.ndarray:
    """Send blocks whose device is fast by `ppm`; return stamps less true times [s]."""
    off = []
    for k in range(1, round(seconds / step_s)):
        true_s = k * step_s
        ticks = round(true_s * (1.0 + 1e-6 * ppm) * TICK_HZ)
        clock.note(ticks, START_NS + round(1e9 * (true_s + delay[k])))
        off.append((clock.utc_ns(ticks) - UTC_NS - START_NS) / 1e9 - true_s)
    return np.array(off)


@given(ppm=st.floats(-150.0, 150.0), seed=st.integers(0, 9))
@settings(max_examples=10)
def test_drift_and_offset_are_found_in_jitter(ppm: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    delay = 0.003 + rng.exponential(0.004, 30_000) + 0.2 * (rng.random(30_000) < 0.01)
    clock = DeviceClock(TICK_HZ, 0, START_NS + 30_000_000, UTC_NS)  # the first block came late
    off = stream(clock, ppm, 120.0, delay)
    assert np.all(np.abs(off[-3000:] - 0.003) < 1e-3)  # the shortest way is what nothing can tell
    state = clock.state
    assert state.ppm == pytest.approx(ppm, abs=max(5.0 * (state.ppm_std or 0.0), 2.0))
    assert state.error_ms is not None and state.error_ms < 1.0


@given(seed=st.integers(0, 9))
@settings(max_examples=10)
def test_stamps_never_go_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    last = 0
    for k in range(1, 4000):
        ticks = k * 10_000
        clock.note(ticks, START_NS + 10_000_000 * k + int(rng.choice([0, 10**6, 10**8, 5 * 10**9])))
        stamps = [clock.utc_ns(ticks - 10_000 + i) for i in (1, 5000, 10_000)]
        assert last < stamps[0] < stamps[1] < stamps[2]
        last = stamps[2]


def test_a_clock_that_is_none_changes_no_rate() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    off = stream(clock, -500_000.0, 60.0, np.zeros(6000))
    assert clock.state.ppm is None
    assert np.isfinite(off).all()


def test_nothing_is_claimed_at_once() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    stream(clock, 50.0, 1.5, np.zeros(500))
    assert (clock.state.ppm, clock.state.ppm_std, clock.state.error_ms) == (None, None, None)
    assert 0.0 < clock.state.rate_std < 50e-6  # no worse than what is known of crystals


@given(ppm=st.one_of(st.floats(-40_000.0, -5_000.0), st.floats(5_000.0, 40_000.0)), seed=st.integers(0, 9))
@settings(max_examples=10)
def test_a_clock_without_a_crystal_is_followed(ppm: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    clock = DeviceClock(TICK_HZ, 0, START_NS + 3_000_000, UTC_NS)
    off = stream(clock, ppm, 20.0, 0.003 + rng.exponential(0.002, 2000))
    state = clock.state
    assert 1.0 / state.rate == pytest.approx(1.0 + 1e-6 * ppm, abs=100e-6)
    assert state.ppm == pytest.approx(ppm, abs=100.0)
    assert np.all(off < 0.1)  # before it was found, no more than a second of it
    assert np.all(np.abs(off[-100:] - 0.003) < 0.01)


def early_ms(clock: DeviceClock, before_ms: float) -> float:
    """Return what a clock says of something that arrived so long before the tick of a second was over."""
    ticks = round(TICK_HZ)
    return 1e3 * clock.early_s(ticks, clock.monotonic_ns(ticks) - round(1e6 * before_ms))


@pytest.mark.parametrize(
    ("before_ms", "early"), [(50.0, 19.0), (30.0, 0.0), (0.0, 0.0), (-80.0, 0.0), (-100.0, -19.0)]
)
def test_until_an_error_is_known_31_ms_are_nobody_s(before_ms: float, early: float) -> None:
    """Three times 10 ms, and 1 ms; what is late may have been gathered for 50 ms more."""
    assert early_ms(DeviceClock(TICK_HZ, 0, START_NS, UTC_NS), before_ms) == pytest.approx(early, abs=1e-6)


def test_a_known_error_takes_the_place_of_the_unknown_one() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    stream(clock, 0.0, 5.0, np.full(500, 0.003))
    error_ms = clock.state.error_ms
    assert error_ms is not None and error_ms < 3.0
    assert early_ms(clock, 20.0) == pytest.approx(20.0 - 1.0 - 3.0 * error_ms, abs=1e-6)


def test_until_a_line_is_known_arrivals_hold_no_stamp_back() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    clock.note(10_000, START_NS + 1_000_000)
    assert clock.utc_ns(10_000) == UTC_NS + START_NS + 10_000_000


def steady(seconds: float, ppm: float = 0.0, late_s: float = 0.0, rate: float = 1.0) -> tuple[DeviceClock, float]:
    """Send blocks of 10 ms that all arrive as late; return the clock, and how late the last stamp is [s]."""
    clock, off_s = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS, rate), 0.0
    for k in range(1, round(100 * seconds) + 1):
        ticks = round(0.01 * k * (1.0 + 1e-6 * ppm) * TICK_HZ)
        clock.note(ticks, START_NS + round(1e9 * (0.01 * k + late_s)))
        off_s = (clock.utc_ns(ticks) - UTC_NS - START_NS) / 1e9 - 0.01 * k
    return clock, off_s


def test_a_clock_begins_at_what_it_is_told() -> None:
    clock = DeviceClock(1e6, 500, START_NS, UTC_NS, 2.0)
    assert clock.state == ClockState(None, None, None, 2.0)
    assert (clock.state.rate_std, ClockState(None, None, None).rate) == (50e-6, 1.0)
    assert clock.monotonic_ns(500) == START_NS and clock.monotonic_ns(1_000_500) == START_NS + 2_000_000_000
    assert clock.utc_ns(500_500) == UTC_NS + START_NS + 1_000_000_000


@pytest.mark.parametrize(("ppm", "crystal"), [(30.0, True), (-60.0, True), (1000.0, False), (-700.0, False)])
def test_an_uncertain_rate_is_drawn_to_a_crystal_s(ppm: float, crystal: bool) -> None:
    """Arrivals without scatter: what all may have waited, a hundredth of a second, is three standard errors."""
    state = steady(20.0, ppm)[0].state
    off = 1.0 / (1.0 + 1e-6 * ppm) - 1.0
    assert state.ppm == pytest.approx(ppm, abs=0.01) and state.ppm_std is not None
    std = 1e-6 * state.ppm_std
    assert std == pytest.approx(0.01 / 3.0 / 19.5, rel=0.06)
    share = 50e-6**2 / (50e-6**2 + std**2)
    assert state.rate - 1.0 == pytest.approx(share * off if crystal else off, rel=1e-3)
    assert state.rate_std == pytest.approx(50e-6 * std / np.hypot(50e-6, std) if crystal else std, rel=1e-6)


def test_stamps_go_through_arrivals_as_they_came() -> None:
    """Though most of a crystal's rate is taken for chance after a second, the stamps lie on the line."""
    clock, off_s = steady(3.0, 100.0)
    assert abs(off_s) < 50e-6
    assert clock.state.error_ms is not None and clock.state.error_ms < 0.1


@pytest.mark.parametrize(
    ("late_s", "seconds", "caught_up"),
    [(0.060, 0.45, False), (0.060, 0.55, True), (0.045, 0.55, False), (0.049, 1.5, False), (0.054, 0.55, True)],
)
def test_stamps_catch_up_with_arrivals_late_twice_in_a_row(late_s: float, seconds: float, caught_up: bool) -> None:
    _, off_s = steady(seconds, late_s=late_s)
    assert (off_s > 0.045) == caught_up
    assert off_s <= late_s + 1e-3


def test_one_late_quarter_of_a_second_is_not_caught_up_with() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    for k in range(1, 300):
        late_ns = 60_000_000 if 60 <= k < 90 else 0
        clock.note(10_000 * k, START_NS + 10_000_000 * k + late_ns)
        assert abs(clock.utc_ns(10_000 * k) - UTC_NS - START_NS - 10_000_000 * k) < 2_000_000


@pytest.mark.parametrize(("early_ms", "held_back"), [(0.9, False), (1.5, True), (3.0, True)])
def test_stamps_are_later_than_arrivals_by_a_millisecond_at_the_most(early_ms: float, held_back: bool) -> None:
    """All arrivals are suddenly earlier; stamps that were later than that are held back to a millisecond."""
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    for k in range(1, 301):
        early_ns = round(1e6 * early_ms) if k > 200 else 0
        clock.note(10_000 * k, START_NS + 10_000_000 * k - early_ns)
        ahead_ms = 1e-6 * (clock.utc_ns(10_000 * k) - UTC_NS - START_NS - 10_000_000 * k) + early_ms * (k > 200)
        assert ahead_ms <= (1.0 if held_back else early_ms) + 5e-3


def test_all_that_arrivals_are_late_by_is_told_as_an_error() -> None:
    clock, _ = steady(4.0)
    for k in range(401, 453):
        clock.note(10_000 * k, START_NS + 10_000_000 * k + 20_000_000)
        clock.utc_ns(10_000 * k)
    assert clock.state.error_ms == pytest.approx(20.0, abs=0.1)
