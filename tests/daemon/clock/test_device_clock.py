"""Stamps follow the device's clock, never go back, and their rate is found in spite of all delays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.clock.device_clock import DeviceClock, _believed
from daemon.clock.least_late import Line

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


def test_a_rate_that_a_crystal_may_have_is_not_taken_from_few_arrivals() -> None:
    rng = np.random.default_rng(1)
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    stream(clock, 0.0, 3.0, 0.003 + rng.exponential(0.01, 300))
    assert abs(clock.state.rate - 1.0) < 30e-6
    std_ppm = clock.state.ppm_std
    assert std_ppm is not None
    both = (50.0**-2 + std_ppm**-2) ** -0.5  # what is known of crystals, and what arrivals say
    assert clock.state.rate_std == pytest.approx(1e-6 * both)


def test_no_stamp_that_is_followed_is_later_than_its_arrival() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    for k in range(1, 1000):
        arrival_ns = START_NS + 10_000_000 * k + 2_000_000
        ticks = round(0.01 * k * 1.03 * TICK_HZ)
        clock.note(ticks, arrival_ns)
        late_s = 1e-9 * (arrival_ns + UTC_NS - clock.utc_ns(ticks))
        assert late_s > (-0.03 if k < 100 else -0.0011)


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


def test_what_all_arrivals_are_late_by_is_an_error_of_the_stamps() -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    stream(clock, 0.0, 5.0, np.full(500, 0.003))
    for k in range(500, 560):
        clock.note(10_000 * k, START_NS + 10_000_000 * k + 33_000_000)  # thirty more than before
    assert clock.state.error_ms == pytest.approx(30.0, abs=3.0)


@pytest.mark.parametrize("std", [2e-6, 50e-6, 400e-6])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_crystal_s_rate_is_the_mean_by_inverse_variances(std: float, sign: float) -> None:
    """Of what was measured and of 0 +- 50 ppm, up to three standard errors of both together."""
    both, crystal, scatter = float(np.hypot(std, 50e-6)), 50e-6**-2, 3e-6
    off = sign * 2.99 * both
    rate, rate_std, slope = _believed(Line(1.0 + off, scatter, std, 0.0, 0.0, 0.0, 1.0))
    assert rate - 1.0 == pytest.approx(off * std**-2 / (std**-2 + crystal), rel=1e-6)
    assert rate_std == pytest.approx((std**-2 + crystal) ** -0.5)
    assert slope - 1.0 == pytest.approx(off * scatter**-2 / (scatter**-2 + crystal), rel=1e-6)
    beyond = 1.0 + sign * 3.01 * both
    assert _believed(Line(beyond, scatter, std, 0.0, 0.0, 0.0, 1.0)) == (beyond, std, beyond)
