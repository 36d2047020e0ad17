"""What is measured of a clock, to the tick: by how much a step may be off, and what a majority is."""

import pytest

from daemon.clock.tick_step import TickStep

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


def test_a_thousand_ticks_tell_a_rate() -> None:
    step = TickStep(1.0, 1e3)
    step.begin(0)
    for k in range(1, 101):
        assert step.std is None
        step.go_on(10, 10, 10 * k, 10)
    assert step.std == pytest.approx(1.5e-3)


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


def test_an_outlier_that_is_left_out_may_hide_half_a_sample_more() -> None:
    """Five steps are off by 1000 and 1005 ticks in all, and twice 501.5 are nobody's."""
    assert decided([*5 * [1140], 2900]).ticks_per_sample == 1000.0
    step = TickStep(1000.0, 1e6)
    step.decide([(10_200, 10)] * 5 + [(29_000, 10)])
    assert step.ticks_per_sample == 1000.0
    step.decide([(10_201, 10)] * 5 + [(29_000, 10)])
    assert step.ticks_per_sample == 1020.1


def test_a_step_that_is_off_by_a_tick_and_a_half_is_near() -> None:
    """Of 2400, 4797 and 4797 ticks for 2, 4 and 4 samples, the first is off by 1.5 ticks at 1199.25 a sample."""
    step = TickStep(1000.0, 1e6)
    step.decide([(2400, 2), (4797, 4), (4797, 4)])
    assert (step.ticks_per_sample, step.measured) == (11_994 / 10, True)


def test_what_a_new_rate_is_known_to() -> None:
    step = decided([1200, 1202, 1201, 1203, 1199])
    assert step.std == pytest.approx((1.5 + JITTERS * 1.0) / 6005)


def test_steps_that_were_gone_on_by_are_heard_in_a_decision() -> None:
    assert decided(3 * [1600], first=2).ticks_per_sample == 1600.0
    assert decided(3 * [1600], first=3).ticks_per_sample == 1000.0


@pytest.mark.parametrize(
    ("claimed", "ticks", "most", "changed"),
    [(320.0, 400, 1.25, True), (320.0, 401, 1.25, False), (320.0, 40, 1.25, True), (320.0, 39, 1.25, False)],
)
def test_a_clock_goes_on_between_an_eighth_and_what_it_may_rise_by(
    claimed: float, ticks: int, most: float, changed: bool
) -> None:
    step = TickStep(claimed, 1e7)
    assert step.changed([(32 * ticks, 32)] * 5, most) == changed
    assert step.ticks_per_sample == (ticks if changed else claimed)


@pytest.mark.parametrize(("off", "changed"), [(202, True), (203, False), (-202, True), (-203, False)])
def test_every_step_must_agree_to_half_a_sample_of_the_new_rate(off: int, changed: bool) -> None:
    step = TickStep(320.0, 1e7)
    assert step.changed([*4 * [(32 * 401, 32)], (32 * 401 + off, 32)]) == changed
    assert (step.ticks_per_sample, step.measured) == ((401.0, True) if changed else (320.0, False))


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


def test_of_two_steps_in_the_middle_the_one_that_info_says_counts() -> None:
    for steps in ([(10_000, 10), (11_200, 10)], [(10_000, 10), (8_800, 10)]):
        step = TickStep(1000.0, 1e6)
        step.decide(steps)
        assert step.ticks_per_sample == 1000.0


@pytest.mark.parametrize(("n", "p"), [(2, 1000.0), (3, 860.0)])
def test_a_slow_rate_within_an_oscillator_s_needs_no_majority_and_one_beyond_it_does(n: int, p: float) -> None:
    within, beyond = TickStep(1000.0, 1e6), TickStep(1000.0, 1e6)
    within.decide([(8_600, 10)] * n)
    beyond.decide([(8_400, 10)] * n)
    assert within.ticks_per_sample == 860.0
    assert beyond.ticks_per_sample == (840.0 if p == 860.0 else p)
