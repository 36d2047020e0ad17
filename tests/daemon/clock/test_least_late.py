"""The rate of a clock is found in spite of delays, and how well is said."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
