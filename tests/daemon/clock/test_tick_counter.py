"""A counter that passes zero goes on; one that was restarted does not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.clock.tick_counter import TickCounter
from protocol.serial_frame import InfoFrame, SamplesRun
from tests.daemon.conftest import device_info

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


def test_a_counter_does_not_turn_back() -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(5000, 0)
    assert counter.shift(4000, 0) == 0
    assert counter.shift(TURN - 1, 1000) == 0


@pytest.mark.parametrize(("first", "shift"), [(TURN - 1, TURN), (TURN, 0)])
def test_a_counter_beyond_32_bits_is_wide(first: int, shift: int) -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(first, 0)
    assert counter.shift(5, 1_000_000) == shift


def test_an_info_is_shifted_as_samples_are_and_turns_nothing() -> None:
    counter, info = TickCounter(TICK_HZ), InfoFrame(3, 7, device_info())
    assert counter.unwrapped(info, 0) is info
    counter.shift(TURN - 10, 0)
    counter.shift(10, 10**6)
    found = counter.unwrapped(info, 10**6)
    assert isinstance(found, InfoFrame) and (found.ticks, found.sequence) == (TURN + 7, 3)
    assert counter.shift(20, 2 * 10**6) == TURN


def test_a_run_across_the_turn_goes_on() -> None:
    counter, counts = TickCounter(TICK_HZ), np.zeros((12, 1), dtype=np.int16)
    counter.shift(TURN - 300, 0)
    run = counter.unwrapped(SamplesRun(5, [TURN - 200, TURN - 100, 0, 100], counts), 30_000)
    assert isinstance(run, SamplesRun) and run.sequence == 5 and run.counts is counts
    assert run.ticks == [TURN - 200, TURN - 100, TURN, TURN + 100]
