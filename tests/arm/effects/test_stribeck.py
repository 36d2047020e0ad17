"""Friction that falls as the joint starts to move."""

import numpy as np
import pytest

CURVE = {"amplitude_N_m": 0.7, "velocity_rad_s": 0.2}


def test_at_its_velocity_an_e_th_is_left(resists):
    found = resists("stribeck", CURVE, dq=[-0.2, -1e-9, 1e-9, 0.2, 0.4])
    np.testing.assert_allclose(found, [-0.7 / np.e, -0.7, 0.7, 0.7 / np.e, 0.7 / np.e**4], rtol=1e-12)


def test_at_rest_it_has_no_direction(resists):
    assert resists("stribeck", CURVE, dq=0.0) == 0.0


def test_a_resting_joint_lets_go_beyond_all_of_it(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "stribeck", **CURVE)
    assert let_go(arm) == pytest.approx(1.1, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-1.1, abs=1.1e-3)


def test_what_it_may_be(ranges):
    ranges("stribeck", "amplitude_N_m", 0.0, 1e3, velocity_rad_s=1.0)
    ranges("stribeck", "velocity_rad_s", 1e-3, 1e2, amplitude_N_m=1.0)
