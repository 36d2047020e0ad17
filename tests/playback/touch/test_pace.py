"""Deadlines, percentiles and who holds the arm, by a clock that the test moves."""

import numpy as np
import pytest

from playback.touch.holders import STALE_S, Holders
from playback.touch.pace import SPIN_S, Pace, Spread


class Clock:
    def __init__(self) -> None:
        self.now_s = 50.0

    def monotonic(self) -> float:
        self.now_s += 1e-6  # looking takes time
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds


def test_delays_do_not_add_up_and_missed_ticks_are_counted() -> None:
    clock = Clock()
    pace = Pace(1e-3, clock.monotonic, clock.sleep)
    start_s, passed = pace.start_s, []
    for busy in (0.0, 0.0004, 0.0009, 0.0035, 0.0):
        clock.now_s += busy
        passed.append(pace.wait())
    assert passed == [1, 1, 1, 3, 1]
    assert (pace.ticks, pace.overruns) == (5, 2)
    assert pace.now_s - start_s == pytest.approx(7e-3, abs=5e-6)
    assert pace.held_rate_hz == pytest.approx(5 / 7e-3, rel=1e-3)
    assert pace.lateness.summary(1e-3)["max"] == pytest.approx(2.5, abs=0.01)


def test_it_sleeps_until_just_before_the_deadline() -> None:
    clock, slept = Clock(), []
    pace = Pace(1e-3, clock.monotonic, lambda s: (slept.append(s), clock.sleep(s)))
    pace.wait()
    assert slept == [pytest.approx(1e-3 - SPIN_S, abs=5e-6)]


def test_percentiles_are_numpys_to_a_microsecond() -> None:
    spread, times = Spread(), np.random.default_rng(0).exponential(2e-4, 5000)
    assert spread.summary(1.0) == {"p50": None, "p99": None, "max": None}
    for seconds in times:
        spread.add(float(seconds))
    found = spread.summary(1.0)
    assert found["p50"] == pytest.approx(np.percentile(times, 50), abs=2e-6)
    assert found["p99"] == pytest.approx(np.percentile(times, 99), abs=5e-6)
    assert found["max"] == times.max()
    spread.add(3.0)
    assert spread.summary(1e-3)["max"] == 3000.0


def test_the_device_whose_touch_began_last_holds_the_arm() -> None:
    holders = Holders()
    assert holders.holder(0.0) is None
    holders.hear(b"a", 0.0)
    holders.hear(b"b", 0.005)
    holders.hear(b"a", 0.010)  # speaks later, but began before
    assert holders.holder(0.010) == b"b"
    assert holders.holder(0.005 + STALE_S) == b"a"
    holders.hear(b"b", 0.026)  # silent for too long: a new touch
    assert holders.holder(0.026) == b"b"
    assert holders.holder(0.026 + STALE_S) is None
    assert len(holders) == 0
    holders.hear(b"c", 1.0)
    holders.hear(b"d", 1.0)
    assert holders.holder(1.0) == b"d"


def test_before_time_has_passed_there_is_no_rate() -> None:
    assert Pace(1e-3, lambda: 50.0).held_rate_hz == 0.0


def test_times_are_told_by_the_middle_of_their_microsecond() -> None:
    spread = Spread()
    spread.add(10.3e-6)
    assert spread.summary(1e-6) == pytest.approx(
        {"p50": 10.3, "p99": 10.3, "max": 10.3}
    )  # never above the longest
    spread.add(99.9e-6)
    assert spread.summary(1e-6) == pytest.approx({"p50": 10.5, "p99": 99.5, "max": 99.9})
    late = Spread()
    for seconds in (0.0199985, 0.02, 0.5):
        late.add(seconds)
    assert late.summary(1e-3) == pytest.approx({"p50": 19.9995, "p99": 19.9995, "max": 500.0})
    late.add(0.0)
    late.add(0.0)
    late.add(0.0)
    assert late.summary(1e-3)["p50"] == pytest.approx(0.0005)


def test_it_begins_anew() -> None:
    clock = Clock()
    pace = Pace(1e-3, clock.monotonic, clock.sleep)
    clock.now_s += 0.5
    assert pace.wait() == 500
    assert (pace.ticks, pace.overruns, pace.period_s) == (1, 499, 1e-3)
    pace.start()
    assert (pace.ticks, pace.overruns, pace.lateness.summary(1.0)["max"]) == (0, 0, None)
    assert pace.start_s == pace.now_s == clock.now_s
    assert pace.wait() == 1
    assert pace.now_s - pace.start_s == pytest.approx(1e-3, abs=5e-6)


def test_sleep_ends_40_microseconds_early() -> None:
    clock, slept = Clock(), []
    pace = Pace(1e-3, clock.monotonic, lambda s: (slept.append(s), clock.sleep(s)))
    pace.wait()
    assert slept == [pytest.approx(960e-6, abs=5e-6)]
    clock.now_s += 970e-6
    pace.wait()  # too late to sleep
    assert len(slept) == 1


def test_a_device_holds_nothing_after_exactly_20_ms() -> None:
    holders = Holders()
    holders.hear(b"a", 0.0)
    assert holders.holder(0.019999) == b"a"
    assert (holders.holder(0.020), len(holders)) == (None, 0)
    holders.hear(b"a", 0.030)
    holders.hear(b"b", 0.040)
    holders.hear(b"a", 0.050)  # silent for 20 ms: it begins anew, and holds what b held
    assert holders.holder(0.050) == b"a"
