"""A constant torque."""

import numpy as np
import pytest

from arm.simulation import simulate


def test_it_drives_the_joint_alike_in_every_state(resists):
    found = resists("torque_offset", {"torque_N_m": 0.3}, q=[0.0, 1.0, -2.0], dq=[-1.0, 0.0, 2.0])
    np.testing.assert_array_equal(found, -0.3)


def test_a_free_wheel_accelerates_by_it(wheel, having):
    none = np.zeros((501, 1))
    motion = simulate(having(wheel, "torque_offset", torque_N_m=0.3), none, 1e-2, np.zeros(1), torque=none)
    np.testing.assert_allclose(motion.q[:, 0], 0.3 / 0.5 * motion.t**2 / 2.0, rtol=0, atol=1e-12)


def test_it_holds_a_resting_joint_off_centre(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "torque_offset", torque_N_m=0.3)
    assert let_go(arm) == pytest.approx(0.1, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.7, abs=1.1e-3)


def test_it_may_drive_either_way(ranges):
    ranges("torque_offset", "torque_N_m", -1e3, 1e3)
