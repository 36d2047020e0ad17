"""A counter that passes zero goes on; one that was restarted does not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.clock.tick_counter import TickCounter
from protocol.serial_frame import SamplesRun

TURN = 1 << 32
TICK_HZ = 1e7


@given(
    first=st.integers(0, TURN - 1),
    pauses=st.lists(st.floats(0.001, 400.0), min_size=1, max_size=30),
    off=st.floats(-0.05, 0.05),
    tick_hz=st.sampled_from([1e6, 1e7, 1e9]),
)
def test_turns_are_counted_across_pauses(first: int, pauses: list[float], off: float, tick_hz: float) -> None:
    counter, now_s = TickCounter(tick_hz), 0.0
    longest_s = 0.2 * TURN / tick_hz / max(abs(off), 0.01)  # beyond it nobody can know
    assert counter.shift(first, 0) == 0
    for pause_s in pauses:
        now_s += min(pause_s, longest_s)
        true = first + round(now_s * (1.0 + off) * tick_hz)
        assert true % TURN + counter.shift(true % TURN, round(1e9 * now_s)) == true


@pytest.mark.parametrize("stood_at", [5 * 10**7, 3 * 10**9])
def test_a_restart_is_no_turn(stood_at: int) -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(stood_at, 0)
    assert counter.shift(1000, 2_000_000_000) == 0


def test_a_frame_from_before_the_turn_belongs_there() -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(TURN - 20_000, 0)
    assert counter.shift(0, 2_000_000) == TURN
    assert counter.shift(TURN - 10_000, 2_000_000) == 0
    assert counter.shift(10_000, 3_000_000) == TURN


def test_a_wide_counter_has_no_turns() -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(TURN + 5, 0)
    assert counter.shift(7, 1_000_000) == 0


@given(pauses=st.lists(st.floats(0.001, 2_000.0), min_size=1, max_size=20), first=st.integers(0, TURN - 1))
def test_runs_are_numbered_on_across_pauses(pauses: list[float], first: int) -> None:
    counter, now_s = TickCounter(TICK_HZ), 0.0
    counts = np.zeros((64, 1), dtype=np.int16)
    for pause_s in (0.0, *pauses):
        now_s += pause_s
        true = first + round(now_s * TICK_HZ)
        sent = SamplesRun(0, [true % TURN, (true + 3200) % TURN], counts)
        found = counter.unwrapped(sent, round(1e9 * now_s))
        assert found.ticks == [true, true + 3200]
