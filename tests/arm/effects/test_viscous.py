"""Friction that grows with the speed."""

import numpy as np

from arm.simulation import simulate


def test_it_resists_in_proportion_to_the_speed(resists):
    found = resists("viscous", {"viscous_N_m_s": 0.4}, dq=[-1.5, 0.0, 2.0])
    np.testing.assert_allclose(found, [-0.6, 0.0, 0.8], rtol=1e-15)


def test_a_free_wheel_slows_down_by_its_exponential(wheel, having):
    none = np.zeros((2001, 1))
    arm = having(wheel, "viscous", viscous_N_m_s=0.2)
    motion = simulate(arm, none, 1e-3, np.zeros(1), np.array([3.0]), torque=none)
    np.testing.assert_allclose(motion.dq[:, 0], 3.0 * np.exp(-0.2 / 0.5 * motion.t), rtol=1e-12)


def test_it_may_be_negative(ranges):
    ranges("viscous", "viscous_N_m_s", -1e3, 1e3)
