"""Sizes of what a model lacks: rounds raise the likelihood, and a race ends with the likeliest."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.model import Arm, Gyroscope
from tests.tracking.smoother.test_discrepancy_smoother import case
from tracking.model.course import course_of
from tracking.model.discrepancy import Discrepancy
from tracking.model.first_rest import resting
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.observation import observation_of
from tracking.model.process_noise import SMOOTHER_PUSH_STD
from tracking.smoother.discrepancy_fit import Begin, DiscrepancyFit, before, departure, likeliest


def fit_of(arm: Arm, seed: int, memory_s: float) -> DiscrepancyFit:
    readings = case(arm, seed, lack=0.3).readings
    course = course_of(readings, 2)._replace(push=np.full(2, SMOOTHER_PUSH_STD**2))
    own = observation_of(arm)[1]
    of, size = observation_of(arm, lack=True)
    start = start_state(arm, of, size, resting(readings.first_mean), np.zeros(2), True, MountingPrior())
    return DiscrepancyFit(arm, of, size, course, memory_s, start, Begin(None, departure(of, course)), own)


def test_rounds_raise_the_likelihood_and_come_to_an_end(vertical_arm: Arm) -> None:
    fit, seen = fit_of(vertical_arm, 1, 0.1), []
    while not fit.is_done:
        fit.advance()
        seen.append(fit.log_likelihood)
    assert fit.converged and np.diff(seen).min() > 0.0
    assert seen[-1] <= fit.limit <= fit.log_likelihood + 100.0
    assert fit.sizes.lack_std == pytest.approx(0.3, rel=0.2)


class Racer:
    """Comes nearer to a limit by half of what is missing in every round."""

    def __init__(self, limit: float, rounds: int = 30) -> None:
        self.limit, self.rounds, self.done, self.log_likelihood, self._gain = limit, rounds, 0, limit - 1e4, 1e9

    @property
    def is_done(self) -> bool:
        return self.done == self.rounds

    @property
    def most_log_likelihood(self) -> float:
        return self.log_likelihood + (self.rounds - self.done) * self._gain

    def advance(self) -> None:
        self._gain = 0.5 * (self.limit - self.log_likelihood)
        self.log_likelihood += self._gain
        self.done += 1


def test_a_race_is_won_by_the_likeliest_and_the_hopeless_give_up() -> None:
    racers, rounds = [Racer(0.0), Racer(10.0), Racer(-5e3)], []
    assert likeliest(racers, [0.0] * 3, lambda: rounds.append(1)) is racers[1]
    assert racers[2].done < 15 and len(rounds) == sum(one.done for one in racers)


def test_prior_odds_against_a_kind_count() -> None:
    racers = [Racer(0.0), Racer(10.0)]
    assert likeliest(racers, [0.0, 11.0], lambda: None) is racers[0]


@pytest.mark.parametrize("turning", [1, 3])
def test_readings_depart_by_their_kinds_loudest_channel_if_by_no_more(dd_arm: Arm, turning: int) -> None:
    turned = tuple(replace(sensor, gyroscope=Gyroscope()) for sensor in dd_arm.sensors[:turning])
    arm = replace(dd_arm, sensors=(*turned, *dd_arm.sensors[turning:]))
    of, n_felt = observation_of(arm)[0], 3 * len(dd_arm.sensors)
    noise = np.ones(n_felt + 3 * turning)
    noise[1], noise[n_felt + 2] = 4.0, 0.25
    noise[n_felt:] *= 0.01
    readings = np.ones((300, noise.size))
    course = SimpleNamespace(dt=0.01, present=np.ones(300, dtype=bool), readings=readings, noise=noise)
    assert departure(of, course).tolist() == [2.0] * n_felt + [0.1] * (3 * turning)  # type: ignore[arg-type]
    course.readings[::2, n_felt:] += 2.0  # a second's mean does not follow this
    np.testing.assert_allclose(departure(of, course)[n_felt:], 1.0, rtol=0.05)  # type: ignore[arg-type]


@pytest.mark.parametrize("base", [True, False])
def test_before_the_first_reading_what_is_lacking_is_as_large_as_ever(dd_arm: Arm, base: bool) -> None:
    of, size = observation_of(dd_arm, base=base, lack=True)
    start = np.arange(float(size)), 7.0 * np.eye(size)
    x, P = before(of, start, Discrepancy(0.3, 0.5, 0.1, np.ones(2)))
    expected = np.full(size, 7.0)
    expected[of.lack_column : of.lack_column + 12] = 0.09
    if base:
        expected[of.base_column : of.base_column + 3] = 0.25
    np.testing.assert_allclose(P, np.diag(expected))
    np.testing.assert_array_equal(x, start[0])
    np.testing.assert_array_equal(start[1], 7.0 * np.eye(size))


def test_clocks_are_let_go_of_a_fit_that_has_had_all_its_rounds(vertical_arm: Arm) -> None:
    """It goes on from its motion and its sizes, for some more rounds."""
    fit = fit_of(vertical_arm, 1, 0.1)
    while fit.rounds < 30:
        fit.advance()
    assert fit.is_done
    readings, before_s = case(vertical_arm, 1, lack=0.3).readings, fit.sizes.lack_std
    of, size = observation_of(vertical_arm, lack=True, clocks=(1, 3))
    start = start_state(vertical_arm, of, size, resting(readings.first_mean), np.zeros(2), True, MountingPrior())
    fit.let_go(of, size, start)
    assert not fit.is_done and fit.clocks.late_s.tolist() == [0.0] * 4
    fit.advance()
    assert fit.found.states.shape == (len(readings.values), size) and np.isfinite(fit.found.states).all()
    assert fit.sizes.lack_std == pytest.approx(before_s, rel=0.1)
