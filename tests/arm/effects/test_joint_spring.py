"""Something elastic that pulls the joint to a rest angle."""

import numpy as np
import pytest

from arm.simulation import simulate

SPRING = {"stiffness_N_m_rad": 3.0, "rest_angle_rad": 0.2}


def test_it_resists_away_from_its_rest_angle(resists):
    found = resists("joint_spring", SPRING, q=[-0.8, 0.2, 1.2])
    np.testing.assert_allclose(found, [-3.0, 0.0, 3.0], atol=1e-15)


def test_a_free_wheel_swings_about_it_with_its_period(wheel, having):
    none = np.zeros((1001, 1))
    motion = simulate(having(wheel, "joint_spring", **SPRING), none, 5e-3, np.array([1.2]), torque=none)
    np.testing.assert_allclose(motion.q[:, 0], 0.2 + np.cos(np.sqrt(3.0 / 0.5) * motion.t), rtol=0, atol=1e-8)


def test_it_holds_a_resting_joint_off_centre(wheel, having, rubbing, let_go):
    stretched = {"stiffness_N_m_rad": 2.0, "rest_angle_rad": -0.1}
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "joint_spring", **stretched)
    assert let_go(arm) == pytest.approx(0.6, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.2, abs=1.1e-3)


def test_what_it_may_be(ranges):
    ranges("joint_spring", "stiffness_N_m_rad", 0.0, 1e4, rest_angle_rad=0.0)
    ranges("joint_spring", "rest_angle_rad", -10.0, 10.0, stiffness_N_m_rad=1.0)
