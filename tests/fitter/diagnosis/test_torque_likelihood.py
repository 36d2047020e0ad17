"""The likelihood of the torque equation: exact where nothing is hidden, and what is hidden comes first."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.arm_hypotheses import RotorInertia
from fitter.diagnosis.drive_hypotheses import Gain
from fitter.diagnosis.evidence import penalised_log_likelihood
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import BLOCK_S
from fitter.diagnosis.screening import screen
from fitter.diagnosis.torque_likelihood import TorqueLikelihood, is_possible
from tests.fitter.diagnosis.searched import found_in, swinging
from tests.fitter.diagnosis.two_joints import regression_of_two

DRAG = Effect("quadratic_drag", {"drag_N_m_s2": 0.5}, joints=(2,))


def tried():
    """Return a few effects at both joints."""
    kinds = catalogue()
    names = ("quadratic_drag", "joint_spring", "cogging", "torque_offset")
    at = [JointHypothesis(kinds[name], joint) for joint in range(2) for name in names]
    drive = [Gain(kinds["gain_error"], (joint,)) for joint in range(2)]
    return [*at, *drive, RotorInertia(kinds["rotor_inertia"], (1,))]


@pytest.fixture(scope="module")
def dragged():
    likelihood = TorqueLikelihood(regression_of_two(DRAG), tried(), screen)
    return likelihood, likelihood.base()


@pytest.fixture(scope="module")
def ranked(dragged):
    likelihood, base = dragged
    return likelihood.options(base)


def test_where_nothing_is_hidden_the_base_model_is_exact():
    likelihood = TorqueLikelihood(regression_of_two(), tried(), screen)
    base = likelihood.base()
    assert likelihood.is_exact(base) and not likelihood.has_large_residual(base)
    assert likelihood.floor.is_none and likelihood.base_floor is likelihood.floor
    assert likelihood.regression.density is None
    assert base.n_number == 0 and np.all(base.density == 0.0)
    np.testing.assert_allclose(base.variance.mean(axis=0), 1.0, rtol=0.5)


def test_blocks_of_about_a_second_know_their_trials(dragged):
    likelihood, base = dragged
    motions = likelihood.regression.motions
    assert (
        len(base.residual) == len(base.block) and len(base.log_likelihood) == len(base.trial) == base.block[-1] + 1
    )
    assert set(base.trial[base.learnt]) == {k for k, motion in enumerate(motions) if motion.learn}
    for k, motion in enumerate(motions):
        lasts = len(motion.t) * motion.dt_s
        assert np.sum(base.trial == k) == pytest.approx(lasts / BLOCK_S, abs=1.0)
    assert np.all(np.diff(base.block) >= 0)


def test_the_hidden_effect_comes_first(dragged, ranked):
    likelihood, base = dragged
    assert not likelihood.is_exact(base) and likelihood.has_large_residual(base)
    assert ranked[0].candidate.hypothesis.key == ("quadratic_drag", (1,))
    assert [penalised_log_likelihood(one) for one in ranked] == sorted(
        map(penalised_log_likelihood, ranked), reverse=True
    )
    assert ranked[0].gain(base) > 20.0 and ranked[0].helps(base)
    assert likelihood.floor is likelihood.base_floor and not likelihood.base_floor.is_none


def test_what_is_lacking_moved_the_arm_in_part(dragged):
    """Twice the masses add half a log 2 a number at most: nobody knows what of what is lacking moved the arm."""
    regression = dragged[0].regression
    x = dragged[1].candidate.x
    model, motions = dragged[1].candidate.model, regression.motions
    more = regression.density.of(model, 2.0 * x, motions) - regression.density.of(model, x, motions)
    assert 0.0 < more < 0.5 * np.log(2.0) * regression.n_effective.sum()


def test_hypotheses_come_and_go(dragged, ranked):
    likelihood, base = dragged
    first, second = ranked[:2]
    keys = [one.candidate.hypothesis.key for one in (first, second)]
    both = likelihood.joined(base, (first, second))
    if both is None:  # its numbers are impossible beside the other's
        both = likelihood.fit_of(first.candidate)
        keys = keys[:1]
    assert [one.key for one in both.candidate.model.hypotheses] == keys
    alone = likelihood.without(both, len(keys) - 1)
    assert [one.key for one in alone.candidate.model.hypotheses] == keys[:-1]
    other = likelihood.instead(first, 0, second)
    assert other is None or [one.key for one in other.candidate.model.hypotheses] == [
        second.candidate.hypothesis.key
    ]
    none = likelihood.without(first, 0)
    np.testing.assert_allclose(none.candidate.squares, base.candidate.squares, rtol=1e-6)


def test_numbers_that_the_catalogue_forbids_are_impossible(ranked):
    first = ranked[0].candidate
    assert is_possible(first)
    signs = np.where(np.arange(len(first.x)) == len(first.x) - 1, -1.0, 1.0)
    assert not is_possible(replace(first, x=signs * first.x))


def test_a_size_that_the_catalogue_forbids_is_none_that_a_search_accepts(dragged, ranked):
    """Under weights of its own the rotor of a free pendulum took all of its mass away, and was named."""
    likelihood, _ = dragged
    first = ranked[0]
    signs = np.where(np.arange(len(first.candidate.x)) < len(first.candidate.x) - 1, 1.0, -1.0)
    forbidden = replace(first, candidate=replace(first.candidate, x=signs * first.candidate.x))
    assert likelihood.is_significant(first) and not likelihood.is_significant(forbidden)


@pytest.mark.parametrize(("variance", "said"), [(1e-8, True), (100.0, True), (np.nan, False)])
def test_what_is_linear_in_no_number_has_to_be_determined(monkeypatch, dragged, ranked, variance, said):
    """A gap with a large standard error was rejected, though nothing else explained the run."""
    likelihood, _ = dragged
    gain = next(one for one in ranked if isinstance(one.candidate.hypothesis, Gain))
    n = len(gain.candidate.x)

    def covered(regression, candidate):
        return SimpleNamespace(covariance=np.diag([1e-6] * n + [variance]))

    monkeypatch.setattr("fitter.diagnosis.torque_likelihood.estimates", covered)
    assert likelihood.is_significant(gain) == said


def test_under_the_weights_of_its_cause_a_model_leaves_little_more_than_noise():
    likelihood = TorqueLikelihood(regression_of_two(DRAG), tried()[:1] + tried()[4:5], screen)
    found = likelihood.reweighted(likelihood.options(likelihood.base())[0])
    assert found.candidate.x[-1] == pytest.approx(0.5, rel=0.1)
    assert not likelihood.has_large_residual(found)
    assert likelihood.floor.ratio[1] < 0.3 * likelihood.base_floor.ratio[1]


def test_weights_are_found_in_turn_with_the_model_until_they_stay_what_they_are():
    """What the base model leaves is so much that numbers under its weights are far off by the sensors' noise."""
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.6}, joints=(1,))
    likelihood = TorqueLikelihood(swinging(drag), [JointHypothesis(catalogue()["quadratic_drag"], 0)], screen)
    base = likelihood.base()
    assert likelihood.base_floor.ratio[0] > 1e4
    found = likelihood.reweighted(likelihood.options(base)[0])
    assert likelihood.floor.is_none and likelihood.is_exact(found)
    assert likelihood.regression.density is None


@pytest.mark.parametrize("hidden", ["quadratic_drag", None])
def test_the_search_by_it_finds_what_is_hidden_and_nothing_else(hidden):
    effects = [Effect(hidden, {"drag_N_m_s2": 0.3}, joints=(1,))] if hidden else []
    tried = [one for one in hypotheses(1) if one.kind.place == "joint"]
    _, found = found_in(swinging(*effects), tried)
    assert [step.hypothesis.kind.name for step in found.steps] == [one.name for one in effects]
    if hidden:
        assert found.final.candidate.x[-1] == pytest.approx(0.3, rel=0.1)


def test_a_model_is_not_exact_if_a_single_trial_shows_more():
    push = Effect("external_push", {"start_s": 19.4, "duration_s": 0.1, "torque_N_m": 0.1}, joints=(1,))
    likelihood = TorqueLikelihood(swinging(push), [], screen)
    base = likelihood.base()
    assert likelihood.floor.is_none
    assert not likelihood.is_exact(base, everywhere=True)
    assert likelihood.is_exact(base)  # the trial may not be learnt from
