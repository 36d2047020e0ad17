"""Percentiles of lateness."""

from playback.lateness import WINDOW, Lateness


def test_nothing_sent_is_no_lateness() -> None:
    assert Lateness().summary_ms() == {"p50": None, "p99": None, "max": None}


def test_percentiles_look_back_so_far_and_the_worst_is_never_forgotten() -> None:
    lateness = Lateness()
    lateness.add(2.0)
    for _ in range(WINDOW):
        lateness.add(0.001)
    assert lateness.summary_ms() == {"p50": 1.0, "p99": 1.0, "max": 2000.0}
