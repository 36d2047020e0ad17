"""A view of a motion against the arm's own equations of motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.newton_euler import inverse_dynamics
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.diagnosis.motion import BaseColumns, view_of
from tests.fitter.diagnosis.two_joints import regression_of_two


@pytest.fixture(scope="module")
def view():
    regression = regression_of_two(trials=2)
    return view_of(regression.motions[0], regression.arm)


def test_base_columns_times_base_parameters_are_the_arms_torque(view):
    base = structural_parameters(view.arm)
    values = base.combination @ standard_parameters(view.arm)
    kept = BaseColumns(view.arm, (), None).of(view.arm)
    x = np.array([values[base.independent.index(int(column))] for column in kept])
    friction = np.array([[one.friction.viscous_N_m_s, one.friction.coulomb_N_m] for one in view.arm.joints]).T
    frictionless = replace(
        view.arm, joints=tuple(replace(one, friction=type(one.friction)()) for one in view.arm.joints)
    )
    expected = inverse_dynamics(frictionless, view.q, view.dq, view.ddq)
    expected += friction[0] * view.dq + friction[1] * view.direction
    np.testing.assert_allclose(view.base(kept) @ x, expected, atol=1e-9)


def test_what_is_denied_or_known_is_not_sought(view):
    free = BaseColumns(view.arm, (), None).of(view.arm)
    n, known = view.arm.n_joint, int(free[0])
    np.testing.assert_array_equal(BaseColumns(view.arm, ("fc",), None).of(view.arm), free[free < 11 * n])
    np.testing.assert_array_equal(BaseColumns(view.arm, (), (known, 2.0)).of(view.arm), free[1:])


def test_a_known_parameter_is_taken_off_the_torque(view):
    kept = BaseColumns(view.arm, (), None).of(view.arm)
    less = view.u - view.target((int(kept[0]), 2.0))
    np.testing.assert_allclose(less, 2.0 * view.base(kept)[..., 0], atol=1e-12)


def test_a_gain_counts_what_resists_and_friction_grows_with_time(view):
    kept = BaseColumns(view.arm, (), None).of(view.arm)
    plain, halved = view.base(kept), replace(view, factor=np.array([0.5, 1.0]))
    np.testing.assert_allclose(halved.base(kept), plain * [[[0.5], [1.0]]], rtol=1e-12)
    np.testing.assert_allclose(halved.arrived, view.u * [2.0, 1.0])
    grown = replace(view, drift=np.array([0.1, 0.0])).base(kept)
    viscous = int(np.flatnonzero(kept == 10 * view.arm.n_joint)[0])
    t = np.maximum(view.motion.t, 0.0)
    np.testing.assert_allclose(grown[:, 0, viscous], plain[:, 0, viscous] * (1.0 + 0.1 * t))
    np.testing.assert_allclose(np.delete(grown, viscous, 2)[:, 1], np.delete(plain, viscous, 2)[:, 1])
