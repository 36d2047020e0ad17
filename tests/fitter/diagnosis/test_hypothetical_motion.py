"""A view of a motion against the arm's own equations of motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.newton_euler import inverse_dynamics
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.diagnosis.motion import BaseColumns, as_measured
from tests.fitter.diagnosis.two_joints import regression_of_two


@pytest.fixture(scope="module")
def hypothetical():
    regression = regression_of_two(trials=2)
    return as_measured(regression.motions[0], regression.arm)


def test_base_columns_times_base_parameters_are_the_arms_torque(hypothetical):
    base = structural_parameters(hypothetical.arm)
    values = base.combination @ standard_parameters(hypothetical.arm)
    kept = BaseColumns(hypothetical.arm, (), None).of(hypothetical.arm)
    x = np.array([values[base.independent.index(int(column))] for column in kept])
    friction = np.array(
        [[one.friction.viscous_N_m_s, one.friction.coulomb_N_m] for one in hypothetical.arm.joints]
    ).T
    frictionless = replace(
        hypothetical.arm,
        joints=tuple(replace(one, friction=type(one.friction)()) for one in hypothetical.arm.joints),
    )
    expected = inverse_dynamics(frictionless, hypothetical.q, hypothetical.dq, hypothetical.ddq)
    expected += friction[0] * hypothetical.dq + friction[1] * hypothetical.direction
    np.testing.assert_allclose(hypothetical.base(kept) @ x, expected, atol=1e-9)


def test_what_is_denied_or_known_is_not_sought(hypothetical):
    free = BaseColumns(hypothetical.arm, (), None).of(hypothetical.arm)
    n, known = hypothetical.arm.n_joint, int(free[0])
    np.testing.assert_array_equal(
        BaseColumns(hypothetical.arm, ("fc",), None).of(hypothetical.arm), free[free < 11 * n]
    )
    np.testing.assert_array_equal(BaseColumns(hypothetical.arm, (), (known, 2.0)).of(hypothetical.arm), free[1:])


def test_a_known_parameter_is_taken_off_the_torque(hypothetical):
    kept = BaseColumns(hypothetical.arm, (), None).of(hypothetical.arm)
    less = hypothetical.u - hypothetical.target((int(kept[0]), 2.0))
    np.testing.assert_allclose(less, 2.0 * hypothetical.base(kept)[..., 0], atol=1e-12)


def test_a_gain_counts_what_resists_and_friction_grows_with_time(hypothetical):
    kept = BaseColumns(hypothetical.arm, (), None).of(hypothetical.arm)
    plain, halved = hypothetical.base(kept), replace(hypothetical, factor=np.array([0.5, 1.0]))
    np.testing.assert_allclose(halved.base(kept), plain * [[[0.5], [1.0]]], rtol=1e-12)
    np.testing.assert_allclose(halved.arrived, hypothetical.u * [2.0, 1.0])
    grown = replace(hypothetical, drift=np.array([0.1, 0.0])).base(kept)
    viscous = int(np.flatnonzero(kept == 10 * hypothetical.arm.n_joint)[0])
    t = np.maximum(hypothetical.motion.t, 0.0)
    np.testing.assert_allclose(grown[:, 0, viscous], plain[:, 0, viscous] * (1.0 + 0.1 * t))
    np.testing.assert_allclose(np.delete(grown, viscous, 2)[:, 1], np.delete(plain, viscous, 2)[:, 1])
