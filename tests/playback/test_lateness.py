"""Percentiles of lateness."""

import pytest

from playback.lateness import WINDOW, Lateness


def test_nothing_sent_is_no_lateness() -> None:
    assert Lateness().summary_ms() == {"p50": None, "p99": None, "max": None}


def test_percentiles_look_back_so_far_and_the_worst_is_never_forgotten() -> None:
    lateness = Lateness()
    lateness.add(2.0)
    for _ in range(WINDOW):
        lateness.add(0.001)
    assert lateness.summary_ms() == {"p50": 1.0, "p99": 1.0, "max": 2000.0}


def test_percentiles_are_of_the_last_twenty_thousand() -> None:
    lateness = Lateness()
    for _ in range(10_001):
        lateness.add(1.0)
    for _ in range(10_000):
        lateness.add(0.0)
    assert lateness.summary_ms() == {"p50": 500.0, "p99": 1000.0, "max": 1000.0}  # half of them each


def test_two_messages_are_half_and_half() -> None:
    lateness = Lateness()
    lateness.add(0.001)
    assert lateness.summary_ms() == {"p50": 1.0, "p99": 1.0, "max": 1.0}
    lateness.add(0.003)
    summary = lateness.summary_ms()
    assert (summary["p50"], summary["p99"], summary["max"]) == pytest.approx((2.0, 2.98, 3.0))
