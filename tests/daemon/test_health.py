"""The heartbeat's numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.health import Delay, Latency
from tracking.frames import Frames

DT_S = 1e-3
T0_NS = 1_700_000_000_000_000_000


def block(first: int, n: int) -> Frames:
    two = np.zeros((n, 2))
    return Frames(first, T0_NS + first * 10**6, DT_S, two, two, two, np.zeros((n, 3)), np.zeros((n, 4, 3)), False)


def test_latency_is_of_the_time_since_it_was_last_asked() -> None:
    latency = Latency()
    assert latency.take() == {"p50": None, "p99": None, "p99_run": None}
    for milliseconds in range(1, 102):
        latency.note(milliseconds / 1000)
    run_ms = pytest.approx(100.0, rel=0.03)
    assert latency.take() == {"p50": pytest.approx(51.0), "p99": pytest.approx(100.0), "p99_run": run_ms}
    assert latency.take() == {"p50": None, "p99": None, "p99_run": run_ms}


@given(st.lists(st.tuples(st.integers(1, 12), st.integers(-5_000_000, 10**9)), min_size=1, max_size=20))
def test_delay_is_of_every_frame_by_its_own_stamp(blocks: list[tuple[int, int]]) -> None:
    delay, first, ages_ms = Delay(), 0, []
    for n, after_ns in blocks:
        delay.note(block(first, n), T0_NS + (first + n) * 10**6 + after_ns)
        ages_ms += [(n - k) + 1e-6 * after_ns for k in range(n)]
        first += n
    assert delay.take() == {
        "mean": pytest.approx(np.mean(ages_ms), abs=1e-6),
        "max": pytest.approx(max(ages_ms), abs=1e-6),
    }
    assert delay.take() == {"mean": None, "max": None}
