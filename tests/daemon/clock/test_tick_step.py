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


def test_the_rate_follows_what_a_crystal_is_off_by() -> None:
    step = TickStep(312.5, 1e7)
    step.begin(0)
    for k in range(1, 5001):
        step.go_on(10_003, 32, 10_003 * k, 32)
        assert step.ticks_per_sample == pytest.approx(10_003 / 32)
        assert step.measured == (k >= MAJORITY)
    assert step.std == pytest.approx(1.5 / (5000 * 10_003), rel=0.1)  # of all five seconds


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


@pytest.mark.parametrize("bits", [24, 32, 40, 62])
def test_steps_that_do_not_agree_change_nothing(bits: int) -> None:
    """By chance five agree to half a sample in 32 once in a million."""
    rng, step = np.random.default_rng(0), TickStep(312.5, 1e7)
    before = step.tolerance_ticks
    for _ in range(1000):
        assert not step.changed([(int(ticks), 32) for ticks in rng.integers(0, 1 << bits, MAJORITY)])
    assert (step.ticks_per_sample, step.tolerance_ticks) == (312.5, before)


@pytest.mark.parametrize(
    ("ticks", "most", "changed"), [(11_000, 1.15, True), (12_000, 1.15, False), (12_000, 9.9, True)]
)
def test_without_the_host_a_rate_rises_by_an_oscillator_s_tolerance(
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
def test_five_steps_outvote_an_info_that_is_far_off(ticks: int) -> None:
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


#: Five standard deviations by the median of what steps are off by.
JITTERS = 5.0 * 1.4826


def gone_on(step: TickStep, off: list[int], ticks: int = 10_000, samples: int = 32) -> TickStep:
    """Take steps that are off by a number of ticks, without a mark from which the rate could be measured."""
    for one in off:
        step.go_on(ticks + one, samples, 0, samples)
    return step


def streamed(step: TickStep, steps: int, every: int = 10_000, extra: int = 0, first: int = 0) -> int:
    """Take frames of 32 samples, each tenth by some ticks too long; return the clock then."""
    ticks = first
    step.begin(first)
    for k in range(1, steps + 1):
        longer = extra if k % 10 == 0 else 0
        ticks += every + longer
        step.go_on(every + longer, 32, ticks, 32)
    return ticks


def test_half_a_sample_and_a_tick_and_a_half_are_nobodys() -> None:
    step = TickStep(312.5, 1e7)
    assert (step.tolerance_ticks, step.back_ticks) == (157.75, -1.5)
    assert step.tolerance() == pytest.approx(0.5 + 1.5 / 312.5)
    assert step.tolerance(100) == pytest.approx(0.5048 + 0.1501 * 100)
    assert (step.late(10_000, 32), step.late(10_625, 32), step.late(9_375, 30)) == (0.0, 2.0, 0.0)


def test_what_steps_agreed_on_narrows_what_longer_ones_may_be_off_by() -> None:
    step = gone_on(TickStep(312.5, 1e7), [0])
    assert step.tolerance(100) == pytest.approx(0.5048 + (1e-4 + 0.5048 / 32) * 100)
    gone_on(step, [0], 3_125, 10)  # a shorter one tells no more
    assert step.tolerance(100) == pytest.approx(0.5048 + (1e-4 + 0.5048 / 32) * 100)
    short = gone_on(TickStep(312.5, 1e7), [0], 625, 2)
    assert short.tolerance(100) == pytest.approx(0.5048 + 0.1501 * 100)  # no oscillator is off by more


def test_a_measured_rate_is_known_to_three_standard_errors() -> None:
    step = TickStep(312.5, 1e7)
    ticks = streamed(step, 100)
    assert step.std == pytest.approx(1.5 / ticks)
    assert step.tolerance(1000) == pytest.approx(0.5048 + (1e-4 + 4.5 / 1e6) * 1000)


def test_jitter_is_measured_from_five_steps_and_anew_from_thirty_one() -> None:
    step = gone_on(TickStep(312.5, 1e7), [10, -30, 20, 50])
    assert (step.measured, step.back_ticks) == (False, -1.5)
    gone_on(step, [-40])
    assert step.measured
    assert step.back_ticks == pytest.approx(-1.5 - JITTERS * 30)
    assert step.tolerance_ticks == pytest.approx(157.75 + JITTERS * 30)
    assert step.tolerance() == pytest.approx(0.5 + (1.5 + JITTERS * 30) / 312.5)
    gone_on(step, 25 * [60])
    assert step.back_ticks == pytest.approx(-1.5 - JITTERS * 30)
    gone_on(step, [60])
    assert step.back_ticks == pytest.approx(-1.5 - JITTERS * 60)
    gone_on(step, 16 * [0] + 15 * [60])  # of the last thirty-one, most are right
    assert step.back_ticks == -1.5


def test_exactly_ten_seconds_are_measured() -> None:
    step = TickStep(312.5, 1e7)
    streamed(step, 15_000)
    assert step.std == pytest.approx(1.5e-8, rel=1e-9)


def test_after_a_loss_the_rate_holds_until_a_second_was_seen() -> None:
    step = TickStep(312.5, 1e7)
    ticks = streamed(step, 3000)
    streamed(step, 999, extra=1, first=ticks)
    assert step.ticks_per_sample == 312.5
    streamed(step, 1000, extra=1, first=ticks)
    assert step.ticks_per_sample == (1e7 + 100) / 32_000


def test_after_a_loss_as_much_is_enough_as_was_seen_before() -> None:
    step = TickStep(312.5, 1e7)
    ticks = streamed(step, 300)
    streamed(step, 299, extra=1, first=ticks)
    assert step.ticks_per_sample == 312.5
    streamed(step, 300, extra=1, first=ticks)
    assert step.ticks_per_sample == (3e6 + 30) / 9_600


def test_a_rate_that_surely_differs_is_measured_before_that() -> None:
    """After 15 frames too long by 10 ticks the clock is 150 ticks ahead, after 16 more than half a sample."""
    step = TickStep(312.5, 1e7)
    ticks = streamed(step, 3000)
    streamed(step, 15, every=10_010, first=ticks)
    assert step.ticks_per_sample == 312.5
    streamed(step, 16, every=10_010, first=ticks)
    assert step.ticks_per_sample == 10_010 / 32


def decided(steps: list[int], first: int = 0) -> TickStep:
    """Return what steps of a sample each tell where INFO says 1000 ticks; some were gone on by before."""
    step = TickStep(1000.0, 1e6)
    gone_on(step, first * [0], 1000, 1)
    step.decide([(one, 1) for one in steps])
    return step


@pytest.mark.parametrize(
    ("steps", "p", "measured"),
    [
        (5 * [1100], 1000.0, True),  # 500 in all: half a sample, and a tick and a half for rounding
        (5 * [1101], 1101.0, True),
        (5 * [900], 1000.0, True),
        (5 * [899], 899.0, True),
        (4 * [1100], 1000.0, False),
        (4 * [1126], 1126.0, True),
        ([*5 * [1200], 2900], 1000.0, True),  # beside an outlier a sample, and three ticks
        ([*5 * [1201], 2900], 1201.0, True),
        ([*5 * [1100], 2900], 1000.0, True),
        (2 * [1150], 1000.0, False),
        (4 * [1150], 1150.0, True),
        (2 * [1300], 1000.0, False),
        (3 * [1300], 1300.0, True),
        ([*3 * [1300], 0, 0], 1300.0, True),
        ([*3 * [1300], 0, 0, 0], 1000.0, True),  # half of them are no majority
        ([*2 * [1300], 0, 0], 1000.0, False),
        ([*2 * [1300], 0, 0, 0], 1000.0, True),
        ([0, 0, -1], 1000.0, False),
        ([], 1000.0, False),
        ([2000, 1000], 1000.0, False),  # of two in the middle that counts which INFO says
        ([1000, 500, 2000, 1000], 1000.0, False),
        (6 * [100], 100.0, True),
        ([1200, 1202, 1201, 1203, 1199], 1201.0, True),
    ],
)
def test_what_a_majority_of_steps_says(steps: list[int], p: float, measured: bool) -> None:
    step = decided(steps)
    assert (step.ticks_per_sample, step.measured) == (p, measured)


def test_what_a_new_rate_is_known_to() -> None:
    step = decided([1200, 1202, 1201, 1203, 1199])
    assert step.std == pytest.approx((1.5 + JITTERS * 1.0) / 6005)


def test_steps_at_the_rate_that_is_known_are_no_change() -> None:
    step = TickStep(320.0, 1e7)
    assert not step.changed([(32 * 320, 32)] * 5)
    assert step.measured


def test_five_strays_that_agree_are_a_new_rate_and_four_are_not() -> None:
    step = TickStep(320.0, 1e7)
    for strays, p in ((4, 320.0), (1, 400.0), (4, 400.0), (1, 300.0)):
        for _ in range(strays):
            step.stray(32 * (400 if step.ticks_per_sample == 320.0 else 300), 32)
        assert step.ticks_per_sample == p
