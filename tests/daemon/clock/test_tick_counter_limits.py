"""How far a counter may be from what is due and still have passed zero."""

import numpy as np
import pytest

from daemon.clock.tick_counter import TickCounter
from protocol.serial_frame import InfoFrame, SamplesRun
from tests.daemon.conftest import device_info

TURN = 1 << 32
TICK_HZ = 1e7


@pytest.mark.parametrize(
    ("elapsed_s", "off", "turned"),
    [
        (1, 102_400_000, True),  # a quarter of what went by, and ten seconds
        (1, 102_500_000, True),
        (1, 102_600_000, False),
        (100, 349_900_000, True),
        (100, 350_100_000, False),
        (100, -349_900_000, True),
        (100, -350_100_000, False),
    ],
)
def test_a_turn_is_one_where_the_hosts_clock_explains_it(elapsed_s: int, off: int, turned: bool) -> None:
    counter, before = TickCounter(TICK_HZ), TURN - 1000
    counter.shift(before, 0)
    now = before + round(elapsed_s * TICK_HZ) + off
    assert counter.shift(now - TURN, elapsed_s * 10**9) == (TURN if turned else 0)


@pytest.mark.parametrize(("off", "turned"), [(TURN // 4 + 2.4e8, True), (TURN // 4 + 2.6e8, False)])
def test_of_a_fast_counter_a_quarter_of_a_turn_may_be_late(off: float, turned: bool) -> None:
    counter, before = TickCounter(1e9), TURN - 1000
    counter.shift(before, 0)
    now = before + 10**9 + round(off)
    assert counter.shift(now - TURN, 10**9) == (TURN if turned else 0)


def test_several_turns_may_pass_unseen() -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(1000, 0)
    true = 1000 + round(900 * TICK_HZ)
    assert true // TURN == 2
    assert counter.shift(true % TURN, 900 * 10**9) == 2 * TURN


def test_a_counter_does_not_turn_back() -> None:
    counter = TickCounter(TICK_HZ)
    counter.shift(5000, 0)
    assert counter.shift(4000, 0) == 0
    assert counter.shift(TURN - 1, 1000) == 0


def test_a_frame_from_before_the_turn_changes_nothing_for_those_after_it() -> None:
    counter = TickCounter(TICK_HZ)
    for ticks, now_ns, shift in (
        (TURN - 10, 0, 0),
        (10, 10**6, TURN),
        (TURN - 5, 10**6, 0),
        (20, 2 * 10**6, TURN),
    ):
        assert counter.shift(ticks, now_ns) == shift


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
