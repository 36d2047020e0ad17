"""Which clocks are followed and how soon, and when stamps leave the line that they were on."""

import numpy as np
import pytest

from daemon.clock.device_clock import ClockState, DeviceClock

TICK_HZ = 1e6
UTC_NS, START_NS = 10**18, 5_000_000_000


def streamed(
    seconds: float, ppm: float = 0.0, late_s: float = 0.0, rate: float = 1.0
) -> tuple[DeviceClock, float]:
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


@pytest.mark.parametrize(
    ("ppm", "followed"), [(-130_000.0, True), (-131_000.0, False), (176_000.0, True), (177_000.0, False)]
)
def test_what_is_off_by_more_than_15_percent_is_no_clock(ppm: float, followed: bool) -> None:
    clock, _ = streamed(4.0, ppm)
    assert clock.state.ppm == (pytest.approx(ppm, abs=1.0) if followed else None)
    assert clock.state.rate == pytest.approx(1.0 / (1.0 + 1e-6 * ppm) if followed else 1.0)


@pytest.mark.parametrize(("seconds", "said"), [(2.0, False), (2.4, True)])
def test_after_two_seconds_a_clock_is_spoken_of(seconds: float, said: bool) -> None:
    state = streamed(seconds)[0].state
    assert [value is not None for value in (state.ppm, state.ppm_std, state.error_ms)] == [said] * 3


@pytest.mark.parametrize(("ppm", "crystal"), [(30.0, True), (-60.0, True), (1000.0, False), (-700.0, False)])
def test_what_a_crystal_may_have_is_drawn_to_it_as_far_as_it_is_uncertain(ppm: float, crystal: bool) -> None:
    """Arrivals without scatter: what all may have waited, a hundredth of a second, is three standard errors."""
    state = streamed(20.0, ppm)[0].state
    off = 1.0 / (1.0 + 1e-6 * ppm) - 1.0
    assert state.ppm == pytest.approx(ppm, abs=0.01) and state.ppm_std is not None
    std = 1e-6 * state.ppm_std
    assert std == pytest.approx(0.01 / 3.0 / 19.5, rel=0.06)
    share = 50e-6**2 / (50e-6**2 + std**2)
    assert state.rate - 1.0 == pytest.approx(share * off if crystal else off, rel=1e-3)
    assert state.rate_std == pytest.approx(50e-6 * std / np.hypot(50e-6, std) if crystal else std, rel=1e-6)


def test_stamps_go_through_arrivals_as_they_came() -> None:
    """Though most of a crystal's rate is taken for chance after a second, the stamps lie on the line."""
    clock, off_s = streamed(3.0, 100.0)
    assert abs(off_s) < 50e-6
    assert clock.state.error_ms is not None and clock.state.error_ms < 0.1


@pytest.mark.parametrize(
    ("late_s", "seconds", "caught_up"),
    [(0.060, 0.45, False), (0.060, 0.55, True), (0.045, 0.55, False), (0.049, 1.5, False), (0.054, 0.55, True)],
)
def test_arrivals_that_are_all_late_twice_in_a_row_are_caught_up_with(
    late_s: float, seconds: float, caught_up: bool
) -> None:
    _, off_s = streamed(seconds, late_s=late_s)
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
    clock, _ = streamed(4.0)
    for k in range(401, 453):
        clock.note(10_000 * k, START_NS + 10_000_000 * k + 20_000_000)
        clock.utc_ns(10_000 * k)
    assert clock.state.error_ms == pytest.approx(20.0, abs=0.1)


@pytest.mark.parametrize(
    ("before_ms", "early_s"), [(31.5, 0.0005), (31.0, 0.0), (30.0, 0.0), (-81.0, 0.0), (-81.5, -0.0005)]
)
def test_what_is_early_is_told_beyond_what_is_not_known(before_ms: float, early_s: float) -> None:
    clock = DeviceClock(TICK_HZ, 0, START_NS, UTC_NS)
    assert clock.early_s(10**6, START_NS + 10**9 - round(1e6 * before_ms)) == pytest.approx(early_s, abs=1e-9)
