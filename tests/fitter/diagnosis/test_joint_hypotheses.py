"""Columns of an effect at a joint, and its numbers recovered from their factors."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.effects.joint_torque import COULOMB, DIRECTION, DQ, TAU, T, torque_along
from fitter.data.trials import to_trials
from fitter.diagnosis.joint_hypotheses import JointHypothesis, depends_on
from fitter.diagnosis.motion import as_measured
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


def _states(n=200):
    rng = np.random.default_rng(1)
    states = rng.normal(size=(n, 7))
    states[:, 3] = np.sign(states[:, 2])
    return states


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("cogging", (0.4, 1.1, 7.0)),
        ("joint_spring", (3.0, -0.4)),
        ("periodic_disturbance", (0.2, 2.5, -2.0)),
        ("stribeck", (0.3, 0.25)),
        ("quadratic_drag", (0.7,)),
    ],
)
def test_numbers_come_back_from_the_factors_of_the_columns(name, values):
    kind = catalogue()[name]
    hypothesis = JointHypothesis(kind, 0)
    order = [parameter.name for parameter in kind.parameters]
    psi = np.array([values[order.index(one)] for one in hypothesis.psi_names])
    states = _states()
    columns = hypothesis._columns(psi, states)
    torque = torque_along(kind, np.array(values), states)
    factors, left, *_ = np.linalg.lstsq(columns, torque, rcond=None)
    assert columns.shape[1] == hypothesis.n_column
    assert np.all(np.abs(columns @ factors - torque) < 1e-9)
    np.testing.assert_allclose(hypothesis.numbers(psi, factors), values, rtol=1e-5, atol=1e-6)


def test_tissue_is_stated_at_a_given_end_of_the_range():
    kind, end = catalogue()["passive_tissue"], {"side": -1.0, "angle_rad": -2.0}
    hypothesis, states = JointHypothesis(kind, 0, end), _states()
    assert hypothesis.psi_names == ("rate_1_rad",)  # moment and damping are columns
    torque = torque_along(kind, np.array([-2.4, 11.03, 11.33, 0.05, -1.0]), states)
    factors = np.linalg.lstsq(hypothesis._columns(np.array([11.33]), states), torque, rcond=None)[0]
    at_end = 11.03 * np.exp(-11.33 * 0.4)
    np.testing.assert_allclose(hypothesis.numbers(np.array([11.33]), factors), [-2.0, at_end, 11.33, 0.05, -1.0])


def test_friction_that_would_push_is_not_possible():
    hypothesis = JointHypothesis(catalogue()["quadratic_drag"], 0)
    assert hypothesis.possible(np.zeros(0), np.array([0.1]))
    assert not hypothesis.possible(np.zeros(0), np.array([-0.1]))


def test_noise_of_the_velocity_does_not_widen_the_hump_of_friction():
    hypothesis, psi, noise = JointHypothesis(catalogue()["stribeck"], 0), np.array([0.08]), 0.02
    still = np.zeros((60, 7))
    still[:, DQ] = np.linspace(0.005, 0.3, 60)
    still[:, DIRECTION] = 1.0
    rng = np.random.default_rng(0)
    seen, corrected = [], []
    for _ in range(2000):
        noisy = still.copy()
        noisy[:, DQ] += noise * rng.normal(size=60)
        seen.append(hypothesis._columns(psi, noisy))
        corrected.append(seen[-1] - hypothesis._bent(psi, noisy, noise, seen[-1]))
    true = hypothesis._columns(psi, still)
    was, left = (float(np.abs(np.mean(some, axis=0) - true).max()) for some in (seen, corrected))
    assert left < 0.25 * was


def test_what_depends_on_the_direction_alone_does_not_bend():
    assert not JointHypothesis(catalogue()["coulomb_asymmetry"], 0)._bends(np.zeros(0))
    assert JointHypothesis(catalogue()["stribeck"], 0)._bends(np.array([0.1]))


def test_at_rest_stands_the_mean_of_what_it_is_either_way():
    """Friction that is stronger forwards holds around its difference; a hump holds either way."""
    trials = to_trials(swings((), trials=2), cutoff_hz=25.0)
    motion = run_of(pendulum(), trials[:1], trials[1:])[0]
    hypothetical = as_measured(replace(motion, direction=np.zeros_like(motion.direction)), pendulum())
    asymmetry, hump = (JointHypothesis(catalogue()[name], 0) for name in ("coulomb_asymmetry", "stribeck"))
    np.testing.assert_array_equal(asymmetry.torque(hypothetical, np.zeros(0)), 1.0)
    np.testing.assert_array_equal(hump.torque(hypothetical, np.array([0.1])), 0.0)


def test_an_effect_is_asked_what_it_depends_on():
    """By what their files say: only friction by load knows the torque, only warm friction the joint's own."""
    kinds = catalogue().values()
    assert [one.name for one in kinds if depends_on(one, TAU)] == ["load_friction"]
    assert [one.name for one in kinds if depends_on(one, COULOMB)] == ["thermal_drift"]
    assert {one.name for one in kinds if depends_on(one, T)} >= {"periodic_disturbance", "thermal_drift"}
