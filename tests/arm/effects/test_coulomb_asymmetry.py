"""Friction that differs by direction."""

import numpy as np
import pytest


def test_it_brakes_forwards_and_drives_backwards(resists):
    found = resists("coulomb_asymmetry", {"difference_N_m": 0.3}, dq=[-3.0, -0.1, 0.0, 0.1, 3.0])
    np.testing.assert_allclose(found, [0.3, 0.3, 0.0, 0.3, 0.3])


def test_a_resting_joint_lets_go_more_easily_backwards(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "coulomb_asymmetry", difference_N_m=0.3)
    assert let_go(arm) == pytest.approx(0.7, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.1, abs=1.1e-3)


def test_either_direction_may_have_more(ranges):
    ranges("coulomb_asymmetry", "difference_N_m", -1e3, 1e3)
