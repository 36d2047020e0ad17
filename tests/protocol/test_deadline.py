"""Beats on absolute deadlines."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.deadline import Ticker


class Time:
    """A clock that only sleeping and working move."""

    def __init__(self, now=0.0, early=1.0):
        self.now = now
        self.early = early

    def clock(self):
        return self.now

    def sleep(self, seconds):
        self.now += max(seconds * self.early, 1e-9)


def test_deadlines_do_not_drift_with_the_work_between():
    time_ = Time(now=5.0)
    ticker = Ticker(0.01, time_.clock, time_.sleep)
    for k in range(1, 1001):
        assert ticker.wait() == pytest.approx(0.0, abs=1e-9)
        assert time_.now == pytest.approx(5.0 + 0.01 * k, abs=1e-9)
        time_.now += 0.007
    assert ticker.k == 1000


def test_a_sleep_that_returns_early_is_repeated():
    time_ = Time(early=0.5)
    ticker = Ticker(1.0, time_.clock, time_.sleep)
    ticker.wait()
    assert 1.0 <= time_.now < 1.001


def test_after_a_delay_the_beats_are_made_up_for():
    time_ = Time()
    ticker = Ticker(1.0, time_.clock, time_.sleep)
    time_.now = 3.5
    assert [ticker.wait() for _ in range(4)] == pytest.approx([2.5, 1.5, 0.5, 0.0])
    assert time_.now == pytest.approx(4.0)
    assert ticker.worst_s == pytest.approx(2.5)


def test_or_they_are_skipped_and_the_beat_stays():
    time_ = Time()
    ticker = Ticker(1.0, time_.clock, time_.sleep)
    time_.now = 3.5
    assert ticker.skip_missed() == 3
    assert ticker.skip_missed() == 0
    assert ticker.wait() == pytest.approx(0.0)
    assert time_.now == pytest.approx(4.0)
    assert (ticker.k, ticker.skipped) == (4, 3)


@given(st.floats(1e-4, 10.0), st.lists(st.floats(0.0, 30.0), max_size=30))
def test_no_beat_is_early_whatever_the_work(period, works):
    time_ = Time(now=1e5)
    ticker = Ticker(period, time_.clock, time_.sleep)
    for work in works:
        time_.now += work
        late = ticker.wait()
        assert late >= 0.0
        assert time_.now >= ticker.deadline_s(ticker.k)
        assert late <= ticker.worst_s


def test_on_the_real_clock_the_rate_is_right():
    ticker = Ticker(0.001, time.monotonic, time.sleep)
    began = time.monotonic()
    for _ in range(100):
        ticker.wait()
    assert 0.0999 < time.monotonic() - began < 1.0


@pytest.mark.parametrize("period", [0.0, -1.0, float("nan")])
def test_a_period_must_be_above_0(period):
    with pytest.raises(ValueError, match="above 0"):
        Ticker(period, time.monotonic, time.sleep)
