"""The heartbeat's numbers."""

import pytest

from daemon.health import Latency


def test_latency_is_of_the_time_since_it_was_last_asked() -> None:
    latency = Latency()
    assert latency.take() == {"p50": None, "p99": None}
    for milliseconds in range(1, 102):
        latency.note(milliseconds / 1000)
    assert latency.take() == {"p50": pytest.approx(51.0), "p99": pytest.approx(100.0)}
    assert latency.take() == {"p50": None, "p99": None}
