"""Where the search for psi begins, the first time and once it has been there."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.arm_hypotheses import FrictionDrift, GravityTilt, JointZero
from fitter.diagnosis.disturbance_pulses import DisturbancePulses
from fitter.diagnosis.drive_hypotheses import Gain, Lag
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import scaled_lstsq
from fitter.diagnosis.model import Model
from fitter.diagnosis.multistart import Multistart
from fitter.diagnosis.refinement import Starts, fitted, refined
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from fitter.diagnosis.screening import screen
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.diagnosis.two_joints import regression_of_two
from tests.fitter.pendulum import pendulum, stop_that_no_learning_trial_reaches, swings

COGGING = Effect("cogging", {"amplitude_N_m": 0.3, "phase_rad": 0.3, "periods_per_turn": 7.0}, joints=(1,))


@pytest.fixture(scope="module")
def regression() -> Regression:
    trials = to_trials(swings((COGGING,), trials=6, seed=2), cutoff_hz=25.0)
    return regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))


def test_the_same_is_found_again_from_few_starts(regression, monkeypatch):
    tried = [
        JointHypothesis(catalogue()[name], 0) for name in ("cogging", "periodic_disturbance", "torque_offset")
    ]
    starts, base = Starts(), fitted(regression, Model())
    first = screen(regression, base, tried, starts)

    def never(*_):
        raise AssertionError("all starts again")

    monkeypatch.setattr(JointHypothesis, "starts", never)
    monkeypatch.setattr("fitter.diagnosis.multistart.peaks", never)
    again = screen(regression, base, tried, starts)
    for one, other in zip(first, again, strict=True):
        assert one.hypothesis.key == other.hypothesis.key
        assert other.squares.sum() == pytest.approx(one.squares.sum(), rel=1e-4)
    assert again[0].model.psi[-1] == pytest.approx([7.0], rel=0.02)


def test_beside_another_model_all_starts_are_tried(regression):
    cogging, offset = (JointHypothesis(catalogue()[name], 0) for name in ("cogging", "torque_offset"))
    starts = Starts()
    starts.keep(Model(), cogging, np.array([[3.0]]))
    assert Multistart(regression, Model(), starts).best(cogging).psi == [3.0]
    beside = Model().plus(offset, np.zeros(0))
    assert Multistart(regression, beside, starts).best(cogging).psi == [7.0]


def test_accepted_psi_that_are_a_little_off_leave_nothing_to_others(regression):
    cogging = JointHypothesis(catalogue()["cogging"], 0)
    learnt = [motion.learn for motion in regression.motions]
    off = Model().plus(cogging, np.array([7.2]))
    as_it_is, at_best = (fitted(regression, off, refine=again).squares[learnt].sum() for again in (False, True))
    grid = Multistart(regression, off, Starts())
    assert as_it_is > 3.0 * at_best
    assert grid.chi2 == pytest.approx(at_best, rel=0.1)
    others = [
        JointHypothesis(catalogue()[name], 0) for name in ("periodic_disturbance", "joint_spring", "torque_offset")
    ]
    assert all(grid.best(one).gain < 0.1 * at_best for one in others)


def test_beside_an_event_a_start_is_judged_by_all_trials():
    trials = to_trials(stop_that_no_learning_trial_reaches(), cutoff_hz=25.0)
    regression = regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))
    hypothesis = JointHypothesis(catalogue()["end_stop"], 0, {"side": 1.0})
    nothing = Pulse(0, 0, 1.0, 0.3, 0.0, 0.01, 0.01, 0.01, 0.01, "bell", 0.0, 0.0)
    push = DisturbancePulses(catalogue()["external_push"], 0, [nothing])
    alone, beside = (
        Multistart(regression, model, Starts()) for model in (Model(), Model().plus(push, push.starts([])[0]))
    )
    assert alone.best(hypothesis).gain < 0.01 * beside.best(hypothesis).gain
    assert beside.best(hypothesis).psi == pytest.approx([0.8], abs=0.1)


def test_a_columns_gain_is_what_fitting_it_takes_off(regression):
    """By products alone the same comes out as by a fit with the base parameters."""
    cogging = JointHypothesis(catalogue()["cogging"], 0)
    starts = np.array([[5.0], [7.0], [9.0]])
    grid = Multistart(regression, Model(), Starts())
    motions = regression.learning
    A = np.vstack([regression.rows(Model(), motion).design for motion in motions])
    y = np.concatenate([regression.rows(Model(), motion).target.ravel() for motion in motions])
    for psi, gain in zip(starts, grid._gains(cogging, starts), strict=True):
        beside = Model().plus(cogging, psi)
        both = np.vstack([regression.rows(beside, motion).design for motion in motions])
        left = [np.sum((y - one @ scaled_lstsq(one, y)) ** 2) for one in (A, both)]
        assert gain == pytest.approx(left[0] - left[1], rel=1e-6, abs=1e-6 * left[0])


def test_the_best_starts_are_told_by_the_trials_of_which_most_is_left(regression):
    """What is tried on all trials holds the best of all starts."""
    lag = Lag(catalogue()["actuator_lag"], (0,))
    starts = lag.starts(regression.learning)
    grid = Multistart(regression, Model(), Starts())
    gains = [grid._gain(lag, psi) for psi in starts]
    foremost = grid._foremost(lag, starts)
    assert len(foremost) < len(starts)
    assert starts[int(np.argmax(gains))] in foremost


def test_where_hardly_anything_is_promised_one_straight_step_finds_it(regression, monkeypatch):
    """Beside the truth a drift of friction has nothing to explain, and the step comes to as much as a search."""
    drift = FrictionDrift(catalogue()["thermal_drift"], (0,))
    truth = fitted(regression, Model().plus(JointHypothesis(catalogue()["cogging"], 0), np.array([7.0]))).model
    grid = Multistart(regression, truth, Starts())
    model = truth.plus(drift, np.array([0.005]))
    searched = grid.gain(drift, refined(regression, model, regression.learning, held=1).psi[-1])

    def never(*_):
        raise AssertionError("a search")

    monkeypatch.setattr("fitter.diagnosis.multistart.refined", never)
    assert grid.best(drift).gain == pytest.approx(searched, abs=0.01 * grid.chi2)
    hidden = Effect("thermal_drift", {"rate_1_s": -0.02}, joints=(1,))
    trials = to_trials(swings((hidden,), trials=4, seed=3), cutoff_hz=25.0)
    other = regression_of(pendulum(), run_of(pendulum(), trials[:2], trials[2:]))
    with pytest.raises(AssertionError, match="a search"):
        Multistart(other, Model(), Starts()).best(drift)


def test_a_tilt_that_makes_masses_felt_is_sought_by_steps():
    """An arm that its file has level hangs: at no tilt its centre of mass is not among what is sought."""
    level = replace(pendulum(), gravity_m_s2=(0.0, 0.0, -9.80665))
    trials = to_trials(swings((), trials=4, seed=3), cutoff_hz=25.0)
    grid = Multistart(regression_of(level, run_of(level, trials[:2], trials[2:])), Model(), Starts())
    assert grid.best(GravityTilt(catalogue()["gravity_tilt"], ())).gain > 0.9 * grid.chi2


def test_what_changes_nothing_explains_nothing_where_friction_has_to_brake():
    """The accepted model is held against others as these are fitted, not against free least squares."""
    plain = swings((), trials=6)
    motions = [replace(one, columns={**one.columns, "ref": 0.6 * one.columns["ref"]}) for one in plain]
    trials = to_trials(motions, cutoff_hz=25.0)
    run = regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))
    likelihood = TorqueLikelihood(run, [], screen)
    base = likelihood.base().candidate
    assert likelihood.regression.density is not None
    grid = Multistart(likelihood.regression, base.model, Starts())
    gain = Gain(catalogue()["gain_error"], (0,))
    assert grid.gain(gain, np.array([1.0])) == pytest.approx(0.0, abs=1e-6 * grid.chi2)


def test_a_zero_that_is_far_off_is_begun_near_it():
    """Rounds go twice as far each: from a hundredth of a radian four of them do not come to a third of one."""
    regression = regression_of_two(Effect("joint_zero", {"offset_rad": 0.35}, joints=(1,)))
    grid = Multistart(regression, Model(), Starts())
    zero = grid.best(JointZero(catalogue()["joint_zero"], (0,)))
    tilt = grid.best(GravityTilt(catalogue()["gravity_tilt"], ()))
    assert zero.psi == pytest.approx([0.35], abs=0.02)
    assert zero.gain == pytest.approx(tilt.gain, rel=0.01)
