"""Percentiles of a run at their edges, and what of a report is reckoned."""

from typing import Any

import numpy as np
import pytest

from daemon.monitoring.health import Delay, Latency
from tests.daemon.monitoring.test_health import DT_S, T0_NS, block


@pytest.mark.parametrize("ms", np.geomspace(0.15, 50_000.0, 60).tolist())
def test_a_percentile_of_the_run_is_rounded_up_by_two_percent_at_most(ms: float) -> None:
    latency = Latency()
    latency.note(1e-3 * ms)
    taken = latency.take()
    assert taken["p50"] == taken["p99"] == pytest.approx(ms)
    assert taken["p99_run"] is not None and ms <= taken["p99_run"] <= 1.0201 * ms


@pytest.mark.parametrize(("ms", "said"), [(0.001, 0.1), (0.1, 0.1), (60_000.0, 60_000.0), (90_000.0, 60_000.0)])
def test_percentiles_of_a_run_lie_between_a_tenth_of_a_millisecond_and_a_minute(ms: float, said: float) -> None:
    latency = Latency()
    latency.note(1e-3 * ms)
    assert latency.take()["p99_run"] == pytest.approx(said)


@pytest.mark.parametrize(("slow", "most_ms"), [(2, 1.02), (3, 103.0)])
def test_one_block_in_a_hundred_may_be_slower_than_the_run_s_percentile(slow: int, most_ms: float) -> None:
    latency = Latency()
    for k in range(200):
        latency.note(0.1 if k < slow else 0.001)
        if k == 100:
            latency.take()
    p99 = latency.take()["p99_run"]
    assert p99 is not None and 0.97 * most_ms < p99 <= most_ms


def test_delay_of_one_block_by_hand() -> None:
    """Three frames a millisecond apart, published 5 ms after the first: they are 5, 4 and 3 ms old."""
    delay = Delay()
    assert delay.take() == {"mean": None, "max": None}
    delay.note(block(0, 3), T0_NS + round(5e9 * DT_S))
    assert delay.take() == {"mean": pytest.approx(4.0), "max": pytest.approx(5.0)}
    delay.note(block(0, 1), T0_NS - 2_000_000)
    assert delay.take() == {"mean": pytest.approx(-2.0), "max": pytest.approx(-2.0)}
    kept: dict[str, Any] = delay.take()
    assert kept == {"mean": None, "max": None}
