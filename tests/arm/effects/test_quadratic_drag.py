"""Resistance that grows with the square of the speed."""

import numpy as np

from arm.simulation import simulate


def test_it_goes_by_the_square_against_the_motion(resists):
    found = resists("quadratic_drag", {"drag_N_m_s2": 0.1}, dq=[-3.0, -1.0, 0.0, 2.0])
    np.testing.assert_allclose(found, [-0.9, -0.1, 0.0, 0.4])


def test_a_free_wheel_slows_down_by_a_hyperbola(wheel, having):
    """``I v' = -c v^2`` is solved by ``v0 / (1 + c v0 t / I)``."""
    none = np.zeros((2001, 1))
    arm = having(wheel, "quadratic_drag", drag_N_m_s2=0.2)
    motion = simulate(arm, none, 1e-3, np.zeros(1), np.array([3.0]), torque=none)
    np.testing.assert_allclose(motion.dq[:, 0], 3.0 / (1.0 + 0.2 * 3.0 * motion.t / 0.5), rtol=1e-10)


def test_it_only_takes(ranges):
    ranges("quadratic_drag", "drag_N_m_s2", 0.0, 1e3)
