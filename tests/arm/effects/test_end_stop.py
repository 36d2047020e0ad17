"""A stiff limit on one side."""

import numpy as np

from arm.simulation import simulate

STOP = {"angle_rad": 0.9, "stiffness_N_m_rad": 200.0}


def test_forwards_it_pushes_back_beyond_its_angle_alone(resists):
    found = resists("end_stop", {**STOP, "side": 1.0}, q=[-3.0, 0.0, 0.89, 0.9, 0.95, 1.1])
    np.testing.assert_allclose(found, [0.0, 0.0, 0.0, 0.0, 10.0, 40.0], atol=1e-12)


def test_backwards_it_pushes_forwards_below_its_angle_alone(resists):
    found = resists("end_stop", {**STOP, "side": -1.0}, q=[0.5, 0.85, 0.9, 0.91, 3.0])
    np.testing.assert_allclose(found, [-80.0, -10.0, 0.0, 0.0, 0.0], atol=1e-12)


def test_a_joint_leaves_it_as_fast_as_it_came(wheel, having):
    none = np.zeros((4000, 1))
    start = np.array([0.5]), np.array([2.0])
    motion = simulate(having(wheel, "end_stop", **STOP, side=1), none, 2e-4, *start, torque=none)
    assert motion.dq[-1, 0] < 0.0
    np.testing.assert_allclose(motion.dq[-1], -2.0, rtol=1e-6)
    np.testing.assert_allclose(motion.q.max(), 0.9 + 2.0 * np.sqrt(0.5 / 200.0), rtol=1e-4)  # half a period in it


def test_what_it_may_be(ranges):
    ranges("end_stop", "angle_rad", -10.0, 10.0, stiffness_N_m_rad=1.0, side=1.0)
    ranges("end_stop", "stiffness_N_m_rad", 0.0, 1e6, angle_rad=0.0, side=1.0)
    ranges("end_stop", "side", -1.0, 1.0, angle_rad=0.0, stiffness_N_m_rad=1.0)
