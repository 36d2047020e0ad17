"""Friction that grows with the load that the joint carries."""

import numpy as np
import pytest


def test_it_takes_its_share_of_the_torque_against_the_motion(resists):
    found = resists("load_friction", {"coefficient": 0.2}, tau=[-5.0, 5.0, -5.0, 5.0, 3.0], dq=[1, 1, -1, -1, 0])
    np.testing.assert_allclose(found, [1.0, 1.0, -1.0, -1.0, 0.0])


def test_a_resting_joint_lets_go_by_what_is_left(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "load_friction", coefficient=0.2)
    assert let_go(arm) == pytest.approx(0.5, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.5, abs=1.1e-3)


def test_it_takes_no_more_than_all(ranges):
    ranges("load_friction", "coefficient", 0.0, 1.0)
