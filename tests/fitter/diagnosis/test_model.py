"""A model moved a little: towards either side, and no further than its numbers may go."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.backlash import backlash_path
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from fitter.diagnosis.transmission_hypotheses import Backlash, Elasticity
from tests.fitter.diagnosis.linear import Columns
from tests.fitter.pendulum import pendulum, swings

BACKLASH = Backlash(catalogue()["backlash"], [0])
TWIST = Elasticity(catalogue()["joint_elasticity"], [0])
ALL = {one.kind.name: one for one in hypotheses(1)}


@pytest.mark.parametrize("psi", [BACKLASH.low, np.array([0.03]), BACKLASH.high])
def test_a_model_is_moved_within_its_bounds(psi):
    ((more, less, apart),) = Model((BACKLASH,), (psi,)).central_differences()
    assert BACKLASH.low <= less.psi[0] <= psi <= more.psi[0] <= BACKLASH.high
    assert apart == more.flat[0] - less.flat[0] > 0.0


def test_one_number_at_a_time():
    model = Model((BACKLASH, TWIST), (np.array([0.03]), np.array([1e-3, 1e-2])))
    moved = [np.flatnonzero(more.flat != less.flat).tolist() for more, less, _ in model.central_differences()]
    assert moved == [[0], [1], [2]]
    assert not list(Model().central_differences())


def test_where_little_changes_jump_an_error_stays_what_it_is():
    effect = Effect("backlash", {"gap_rad": 0.02}, joints=(1,))
    trials = to_trials(swings((effect,), trials=4, seed=1), cutoff_hz=25.0)
    regression = regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))
    plays = [backlash_path(pendulum(), motion, 0) for motion in regression.motions[:3]]

    def off(gap: float) -> float:
        return sum(float(np.sum(np.abs(play.off(gap)))) for play in plays)

    gaps = 0.02 * np.linspace(0.25, 0.4, 1501)  # too small, so that crossings seem too long
    for _ in range(3):  # … and one more is believed from some gap on
        at = int(np.argmax(np.abs(np.diff([off(gap) for gap in gaps]))))
        gaps = np.linspace(gaps[at], gaps[at + 1], 101)
    found = []
    for gap in (0.99 * gaps[0], gaps[0], 1.01 * gaps[-1]):
        one = fitted(regression, Model((BACKLASH,), (np.array([gap]),)), refine=False)
        found.append(estimates(regression, one).effects[0]["gap_rad"].std)
    assert max(found) < 2.0 * min(found)


def test_its_hypothesis_is_the_last():
    first, second = Columns(0), Columns(1)
    model = Model().plus(first, np.zeros(0)).plus(second, np.zeros(0))
    assert Candidate(model, np.zeros(2), np.ones(3)).hypothesis is second
    assert Candidate(model.without(1), np.zeros(1), np.ones(3)).hypothesis is first


def named(names):
    """Return the names of a model's hypotheses in the order in which they act."""
    model = Model()
    for name in names:
        model = model.plus(ALL[name], np.zeros(len(ALL[name].low)))
    return [model.hypotheses[k].kind.name for k in model.downstream()], model


@given(st.permutations(["cogging", "actuator_delay", "gain_error", "torque_saturation"]))
def test_what_acts_on_the_torque_comes_before_columns_are_made_of_it(names):
    order, model = named(names)
    assert order == ["gain_error", "torque_saturation", "actuator_delay", "cogging"]
    assert not model.scales_only


@given(st.permutations(["cogging", "joint_spring", "gain_error"]))
def test_a_gain_that_nothing_feels_comes_last_and_columns_stay_in_their_order(names):
    order, model = named(names)
    assert model.scales_only
    assert order == [*(name for name in names if name != "gain_error"), "gain_error"]
