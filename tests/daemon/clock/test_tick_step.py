"""The ticks of a sample are those of the majority."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.clock.tick_step import MAJORITY, TickStep


@given(p=st.floats(290.0, 340.0), losses=st.sets(st.integers(0, 6), max_size=2))
def test_two_losses_do_not_outvote_five_steps(p: float, losses: set[int]) -> None:
    step = TickStep(312.5, 1e7)
    step.decide([(round(32 * p * (3 if k in losses else 1)), 32) for k in range(7)])
    assert step.measured
    steps = 7 - len(losses)
    most = (1 + len(losses)) * step.tolerance_ticks + 0.5 * steps  # the sum's tolerance, and rounding
    assert abs(step.ticks_per_sample - p) * 32 * steps <= most
    if step.ticks_per_sample != 312.5:
        assert step.ticks_per_sample == pytest.approx(p, rel=1e-3)


def test_info_is_right_unless_most_steps_contradict_it() -> None:
    step = TickStep(312.5, 1e7)
    step.decide([(20_000, 32), (10_000, 32)])
    assert step.ticks_per_sample == 312.5 and not step.measured


def test_ticks_between_two_whole_numbers_are_no_losses() -> None:
    step = TickStep(1.0 / 32.0, 1e3)
    step.decide([(64 + k % 2, 2000) for k in range(6)])
    assert step.ticks_per_sample == 64.5 / 2000.0


def test_jitter_of_the_clock_widens_what_is_no_loss() -> None:
    rng, step, before = np.random.default_rng(0), TickStep(312.5, 1e7), 0
    step.begin(0)
    for k in range(1, 200):
        ticks = 10_000 * k + int(rng.normal(0.0, 100.0))
        step.go_on(ticks - before, 32, ticks, 32)
        before = ticks
    assert 2.0 < step.tolerance() < 6.0  # five times 141 ticks, in samples, and half of one
    assert not step.went_back(-300) and step.went_back(-2000)
    assert step.ticks_per_sample == pytest.approx(312.5, rel=1e-3)
    assert step.changed([(11_000 + off, 32) for off in (0, 300, -300, 200, -200)])


def test_one_sample_more_is_more_than_rounding_explains() -> None:
    step = TickStep(312.5, 1e7)
    assert step.late(33 * 10_000 // 32, 32) == pytest.approx(1.0, abs=0.01)
    assert 0.5 < step.tolerance() < 0.6  # half a sample, and what two rounded stamps may be off
    assert 0.5 * 312.5 < step.tolerance_ticks < 0.6 * 312.5


def test_the_rate_follows_what_a_crystal_is_off_by() -> None:
    step = TickStep(312.5, 1e7)
    step.begin(0)
    for k in range(1, 5001):
        step.go_on(10_003, 32, 10_003 * k, 32)
        assert step.ticks_per_sample == pytest.approx(10_003 / 32)
        assert step.measured == (k >= MAJORITY)
    assert step.std == pytest.approx(1.5 / (5000 * 10_003), rel=0.1)  # of all five seconds


def test_only_the_last_ten_seconds_are_measured() -> None:
    step = TickStep(312.5, 1e7)
    step.begin(0)
    for k in range(1, 15_001):
        step.go_on(10_000, 32, 10_000 * k, 32)
    assert step.std == pytest.approx(1.5 / 1e8, rel=0.1)


def test_steps_before_a_doubt_count_for_the_majority() -> None:
    step = TickStep(312.5, 1e7)
    for _ in range(2):
        step.go_on(11_000, 32, 0, 32)
    step.decide([(11_000, 32)] * 3)
    assert step.measured and step.ticks_per_sample == pytest.approx(343.75)


def test_two_steps_are_enough_for_what_an_oscillator_is_off_by() -> None:
    step = TickStep(312.5, 1e7)
    step.decide([(11_000, 32)] * 2)
    assert step.ticks_per_sample == pytest.approx(343.75)


def test_few_strays_change_nothing() -> None:
    step = TickStep(312.5, 1e7)
    for _ in range(MAJORITY - 1):
        step.stray(10_400, 32)
    step.go_on(10_000, 32, 10_000, 32)
    step.stray(10_400, 32)
    assert step.ticks_per_sample == 312.5


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("bits", [24, 32, 40, 62])
def test_steps_that_do_not_agree_change_nothing(seed: int, bits: int) -> None:
    rng, step = np.random.default_rng(seed), TickStep(312.5, 1e7)
    before = step.tolerance_ticks
    for _ in range(50):
        assert not step.changed([(int(ticks), 32) for ticks in rng.integers(0, 1 << bits, MAJORITY)])
    assert (step.ticks_per_sample, step.tolerance_ticks) == (312.5, before)


@pytest.mark.parametrize(
    ("ticks", "most", "changed"), [(11_000, 1.15, True), (12_000, 1.15, False), (12_000, 9.9, True)]
)
def test_a_rate_that_the_host_was_not_asked_about_rises_by_what_an_oscillator_is_off(
    ticks: int, most: float, changed: bool
) -> None:
    step = TickStep(312.5, 1e7)
    assert step.changed([(ticks, 32)] * MAJORITY, most) == changed
    assert step.ticks_per_sample == (ticks / 32 if changed else 312.5)


@pytest.mark.parametrize("creep", [1, 50, 1_000])
def test_a_clock_that_creeps_is_followed_no_more_than_one_that_stands_still(creep: int) -> None:
    step = TickStep(312.5, 1e7)
    assert not step.changed([(creep, 32)] * MAJORITY)
    assert step.ticks_per_sample == 312.5


@pytest.mark.parametrize("given", [[(578_914_651_260, 32), (467_748_324_184, 32)], [(400_000_000, 32)] * 2])
def test_two_steps_are_no_majority_for_what_no_oscillator_is_off_by(given: list[tuple[int, int]]) -> None:
    step = TickStep(312.5, 1e7)
    step.decide(given)
    assert step.ticks_per_sample == 312.5


@pytest.mark.parametrize("ticks", [5_000, 20_000, 40_000])
def test_an_info_that_is_off_by_far_is_wrong_if_five_steps_say_so(ticks: int) -> None:
    step = TickStep(312.5, 1e7)
    step.decide([(ticks, 32)] * MAJORITY)
    assert step.measured and step.ticks_per_sample == ticks / 32


def test_a_clock_that_goes_back_by_more_than_rounding_went_back() -> None:
    step = TickStep(312.5, 1e7)
    assert not step.went_back(10_000)
    assert not step.went_back(0)
    assert not step.went_back(-1)
    assert step.went_back(-2)
    assert step.went_back(-10_000)
