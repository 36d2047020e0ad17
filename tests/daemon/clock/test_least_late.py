"""The rate of a clock is found in spite of delays, and how well is said."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import linregress

from daemon.clock.least_late import LeastLate, Line


def followed(rate: float, seconds: float, delays: np.ndarray, step_s: float = 0.01) -> Line | None:
    arrivals, line = LeastLate(1.0), None
    for k in range(round(seconds / step_s)):
        host_s = k * step_s
        if arrivals.note(host_s / rate, host_s + float(delays[k])):
            line = arrivals.line() or line
    return line


@given(off=st.floats(-0.04, 0.04), seed=st.integers(0, 9), seconds=st.sampled_from([1.0, 5.0, 30.0]))
@settings(max_examples=25)
def test_the_rate_lies_within_three_standard_errors(off: float, seed: int, seconds: float) -> None:
    rng = np.random.default_rng(seed)
    delays = 0.003 + rng.exponential(0.002, 3000) + 0.1 * (rng.random(3000) < 0.02)
    line = followed(1.0 + off, seconds, delays)
    assert line is not None
    assert abs(line.rate - 1.0 - off) < 3.0 * line.rate_std
    assert line.rate_std >= 0.01 / 3.0 / (1.3 * seconds)  # what a busy host may do is in it


def test_a_stall_of_all_arrivals_is_an_outlier() -> None:
    delays = np.full(3000, 0.003)
    delays[1000:1300] += np.linspace(3.0, 0.0, 300)  # three seconds in which nothing was read
    line = followed(1.0, 30.0, delays)
    assert line is not None and line.rate == pytest.approx(1.0, abs=2e-5)


def test_too_few_arrivals_are_no_line() -> None:
    assert followed(1.0, 0.15, np.zeros(100)) is None


def in_stretches(late_s: np.ndarray, rate: float = 1.0) -> LeastLate:
    """Return what noted one arrival that counts in each stretch of an eighth of a second, so much late."""
    arrivals = LeastLate(rate)
    for k, late in enumerate(late_s):
        assert not arrivals.note(k / 8, rate * k / 8 + 9.0)
        assert arrivals.note((k + 0.5) / 8, rate * (k + 0.5) / 8 + float(late))
    return arrivals


def test_the_line_is_that_of_least_squares() -> None:
    late = 0.001 * np.array([3.0, 1.0, 2.0, 4.0, 2.0, 1.5, 3.5])
    line = in_stretches(late).line()
    device = (np.arange(7) + 0.5) / 8
    by_scipy = linregress(device, device + late)
    assert line is not None
    assert line.rate == pytest.approx(by_scipy.slope, abs=1e-12)
    assert line.scatter_std == pytest.approx(by_scipy.stderr)
    assert line.spread_s == pytest.approx(by_scipy.stderr * np.sqrt(np.sum((device - device.mean()) ** 2)))
    assert (line.device_s, line.host_s) == pytest.approx((device.mean(), (device + late).mean()))
    assert line.span_s == pytest.approx(6 / 8)
    assert line.rate_std == pytest.approx(np.hypot(by_scipy.stderr, 0.01 / 3.0 / 0.75))


def test_an_outlier_is_left_out_of_line_and_spread() -> None:
    late = 0.001 * np.array([3.0, 1.0, 2.0, 4.0, 2.0, 1.5, 3.5, 500.0, 2.0, 3.0, 1.0, 2.0])
    line, device = in_stretches(late).line(), (np.arange(12) + 0.5) / 8
    rest = np.arange(12) != 7
    by_scipy = linregress(device[rest], (device + late)[rest])
    assert line is not None
    assert (line.rate, line.scatter_std) == pytest.approx((by_scipy.slope, by_scipy.stderr))
    assert (line.device_s, line.span_s) == pytest.approx((device[rest].mean(), 11 / 8))


def test_arrivals_on_a_line_are_all_taken() -> None:
    line = in_stretches(np.zeros(8), rate=1.125).line()
    assert line is not None and line.rate == pytest.approx(1.125)
    assert line.spread_s == pytest.approx(0.0, abs=1e-12)


def test_four_stretches_are_a_line_and_three_are_none() -> None:
    assert in_stretches(np.zeros(3)).line() is None
    assert in_stretches(np.zeros(4)).line() is not None


@pytest.mark.parametrize("late_s", [[0.0, 0.5], [0.5, 0.0]])
def test_stretches_are_joined_by_the_least_late(late_s: list[float]) -> None:
    line = in_stretches(np.tile(late_s, 8)).line()
    assert line is not None
    assert (line.rate, line.spread_s, line.span_s) == pytest.approx((1.0, 0.0, 14 / 8), abs=1e-12)


def test_stretches_grow_to_four_seconds_and_256_are_kept() -> None:
    arrivals, gaps, last = LeastLate(1.0), [], -1
    for k in range(33_000):
        if arrivals.note(k / 16, k / 16):
            gaps.append(k - last)
            last = k
    grown = [2] * 16 + [3] * 8 + [5] * 8 + [9] * 8 + [17] * 248 + [33] * 128
    assert gaps[: len(grown)] == grown
    assert len(gaps) > len(grown) + 256 and set(gaps[len(grown) :]) == {65}
    line = arrivals.line()
    assert line is not None and line.span_s == 255 * 65 / 16


def test_lateness_is_judged_by_the_rate_given_and_then_by_the_line() -> None:
    fresh, found = LeastLate(0.5), in_stretches(np.zeros(4), rate=0.5)
    assert found.line() is not None
    for arrivals in (fresh, found):
        for k in range(4, 8):  # the first of each two is less late, by 10 ms
            arrivals.note(k / 8, 0.5 * k / 8)
            arrivals.note((k + 0.5) / 8, 0.5 * (k + 0.5) / 8 + 0.01)
    first, second = fresh.line(), found.line()
    assert first is not None and second is not None
    assert (first.rate, first.device_s) == pytest.approx((0.5, 5.5 / 8))
    assert (second.rate, second.device_s) == pytest.approx((0.5, (2.0 + 5.5) / 2 / 8))


def test_arrivals_at_one_moment_are_no_line() -> None:
    arrivals = LeastLate(1.0)
    arrivals.note(0.0, 0.0)
    for _ in range(4):
        assert not arrivals.note(0.0, 0.0)
    assert arrivals.line() is None
