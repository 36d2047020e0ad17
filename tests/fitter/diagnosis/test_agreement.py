"""What most trials agree on is not bent by what happened in a few."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.base_parameters import base_parameters
from arm.model import Effect
from arm.regressor import standard_parameters
from fitter.data.trials import to_trials
from fitter.diagnosis.agreement import agreed, apart, disagreement, typical
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from tests.fitter.pendulum import pendulum, swings

PUSHES = tuple(
    Effect("external_push", {"start_s": start, "duration_s": 0.6, "torque_N_m": 4.0}, joints=(1,))
    for start in (1.0, 4.2)
)


def test_a_push_in_two_of_eight_trials_does_not_bend_what_they_agree_on():
    pushed = [*swings(PUSHES[:1], trials=2, seed=2), *swings((), trials=8, seed=3)[2:]]
    trials = to_trials(pushed, cutoff_hz=25.0)
    regression = Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    true = base_parameters(pendulum()).combination @ standard_parameters(pendulum())
    bent = np.abs(regression.solve(Model(), regression.motions) - true)
    straight = np.abs(agreed(regression, Model()) - true)
    assert straight.max() < 0.03
    assert straight.max() < 0.3 * bent.max()


@given(st.lists(st.floats(0.5, 2.0), min_size=8, max_size=30), st.integers(0, 7), st.floats(20.0, 1e6))
@settings(max_examples=60)
def test_only_what_is_far_off_and_rare_stands_apart(ratios, place, factor):
    told = np.full(len(ratios), 50.0)
    squares = np.array(ratios) * told
    assert not np.any(apart(squares, told))
    squares[place] *= factor
    alone = apart(squares, told)
    assert alone[place]
    assert np.sum(alone) == 1


def test_half_of_the_trials_never_stand_apart():
    squares = np.array([1.0, 1.0, 900.0, 900.0, 900.0, 900.0, 900.0, 1.0])
    assert not np.any(apart(squares, np.ones(8)))


def test_what_is_typical_is_not_moved_far_by_one_trial():
    squares = np.full(20, 200.0)
    assert typical(squares, np.full(20, 100.0)) == pytest.approx(2.0)
    squares[7] *= 1e4
    assert typical(squares, np.full(20, 100.0)) == pytest.approx(2.0 * 1e4**0.05)


def test_no_trial_counts_for_many():
    told = np.ones(10)
    little_everywhere, much_in_one = np.full(10, 4.0), np.ones(10)
    much_in_one[3] = 1e4
    assert much_in_one.sum() > little_everywhere.sum()
    assert disagreement(much_in_one, told) < disagreement(little_everywhere, told)
    assert disagreement(told, told) == 0.0
