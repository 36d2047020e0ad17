"""Equations that are worked out step by step are those that are worked out at once."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.arm_hypotheses import FrictionDrift, JointZero
from fitter.diagnosis.drive_hypotheses import Gain, Lag
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from tests.fitter.diagnosis.two_joints import regression_of_two

KINDS = catalogue()
ZERO = JointZero(KINDS["joint_zero"], (1,)), np.array([0.05])
LAG = Lag(KINDS["actuator_lag"], (0,)), np.array([0.02])
GAIN = Gain(KINDS["gain_error"], (1,)), np.array([0.8])
DRIFT = FrictionDrift(KINDS["thermal_drift"], (0,)), np.array([0.02])
SPRING = JointHypothesis(KINDS["joint_spring"], 0), np.zeros(0)


@pytest.fixture(scope="module")
def regression():
    return regression_of_two(trials=2)


def model_of(*some):
    model = Model()
    for hypothesis, psi in some:
        model = model.plus(hypothesis, psi)
    return model


@pytest.mark.parametrize(
    "some", [(ZERO, LAG), (GAIN,), (SPRING, GAIN), (DRIFT, GAIN, SPRING), (LAG, SPRING, ZERO)]
)
def test_what_is_known_of_another_model_changes_nothing(regression, some):
    motion, equations = regression.motions[0], regression.equations
    for k in range(len(some)):
        equations.rows(model_of(*some[:k]), motion)
    fresh = Equations(regression.arm, regression.weighting)
    whole = fresh.weighting.filtered(
        motion, fresh.hypothetical(model_of(*some), motion).equations(fresh.independent(regression.arm))
    )
    known = equations.rows(model_of(*some), motion)
    np.testing.assert_allclose(known.design, whole.reshape(known.design.shape), atol=1e-7)


def test_what_is_left_of_a_torque_that_the_factors_make_is_nothing(regression):
    motion, equations, model = regression.motions[0], regression.equations, model_of(SPRING)
    hypothetical = equations.hypothetical(model, motion)
    design = hypothetical.equations(equations.independent(hypothetical.arm))
    x = np.linalg.lstsq(design.reshape(-1, design.shape[2]), hypothetical.u.ravel(), rcond=None)[0]
    left = equations.residual_torque(model, x, motion)
    np.testing.assert_allclose(np.tensordot(left, design, ((0, 1), (0, 1))), 0.0, atol=1e-6)


def test_slopes_are_differences_of_what_is_left(regression):
    motion, equations, model = regression.motions[0], regression.equations, model_of(ZERO, SPRING)
    x = regression.solve(model, regression.motions)
    slopes, step = equations.slopes(model, x, motion), 1e-5
    for k in range(len(x)):
        moved = x + step * (np.arange(len(x)) == k)
        less = equations.residual_torque(model, x, motion) - equations.residual_torque(model, moved, motion)
        np.testing.assert_allclose(slopes[..., k], less / step, atol=1e-5)
    moved = equations.residual_torque(model.at(model.flat + step), x, motion)
    np.testing.assert_allclose(
        slopes[..., -1], (equations.residual_torque(model, x, motion) - moved) / step, atol=1e-2
    )


def test_friction_is_read_from_the_factors(regression):
    kept = regression.equations.independent(regression.arm)
    x = np.arange(len(kept), dtype=np.float64)
    friction = regression.equations.friction(Model(), x, regression.motions[0])
    n = regression.arm.n_joint
    for k, column in enumerate(kept):
        if column >= 10 * n:
            assert friction[(column - 10 * n) % n, (column - 10 * n) // n] == k
