"""INFO's rate is used until another is sure."""

import pytest

from daemon.clock.device_clock import ClockState
from daemon.clock.sample_rate import SampleRate
from daemon.clock.tick_step import TickStep

HONEST = ClockState(None, None, None)


def step_of(ticks: int, frames: int) -> TickStep:
    step = TickStep(312.5, 1e7)
    step.begin(0)
    if abs(ticks - 10_000) > 170:
        step.decide([(ticks, 32)] * 5)
    for k in range(1, frames):
        step.go_on(ticks, 32, k * ticks, 32)
    return step


def test_nothing_is_said_before_it_is_measured() -> None:
    rate = SampleRate(32000.0, 1e7)
    rate.look(step_of(10_000, 3), HONEST)
    assert rate.measured_hz is None and rate.dt_s(0) == 1.0 / 32000.0


def test_a_rate_within_a_crystals_is_said_and_not_used() -> None:
    rate = SampleRate(32000.0, 1e7)
    rate.look(step_of(10_001, 300), HONEST)
    assert rate.measured_hz == pytest.approx(32000.0 / 1.0001)
    assert rate.in_use_hz == 32000.0


@pytest.mark.parametrize("ticks", [9_600, 10_050, 10_400])
def test_a_rate_that_info_is_wrong_of_is_used(ticks: int) -> None:
    rate = SampleRate(32000.0, 1e7)
    rate.look(step_of(ticks, 300), HONEST)
    assert rate.in_use_hz == rate.measured_hz == pytest.approx(1e7 * 32 / ticks, rel=1e-9)
    assert rate.dt_s(5) == 1.0 / rate.in_use_hz


def test_a_clock_that_is_off_makes_the_rate_off_once_it_is_sure() -> None:
    rate = SampleRate(32000.0, 1e7)
    rate.look(step_of(10_000, 300), ClockState(None, None, None, 1.0 / 0.96, 0.02))
    assert (rate.measured_hz, rate.in_use_hz) == (pytest.approx(30720.0), 32000.0)
    rate.look(step_of(10_000, 300), ClockState(None, None, None, 1.0 / 0.96, 0.002))
    assert rate.in_use_hz == pytest.approx(30720.0)


class Measured:
    """What a step's measurement is, as the test says."""

    def __init__(self, ticks: float, std: float | None, measured: bool = True) -> None:
        self.ticks_per_sample, self.std, self.measured = ticks, std, measured


@pytest.mark.parametrize(("std", "measured"), [(None, True), (1e-7, False)])
def test_what_is_not_measured_yet_is_info_s(std: float | None, measured: bool) -> None:
    rate = SampleRate(32000.0, 1e7)
    rate.look(Measured(400.0, std, measured), HONEST)  # type: ignore[arg-type]
    assert (rate.measured_hz, rate.std_ppm, rate.in_use_hz, rate.claimed_hz) == (None, None, 32000.0, 32000.0)


def test_both_clocks_make_the_error_of_a_rate() -> None:
    rate = SampleRate(32000.0, 1e7)
    rate.look(Measured(312.5, 3e-6), ClockState(None, None, None, 1.0, 4e-6))  # type: ignore[arg-type]
    assert rate.std_ppm == pytest.approx(5.0)
