"""A gain other than was said."""

import numpy as np
import pytest

from arm.simulation import simulate


def test_the_joint_gets_its_share_of_what_is_asked(wheel, having, held):
    motion = simulate(having(wheel, "gain_error", factor=0.7), held(0.7, 300), 1e-3, np.zeros(1))
    np.testing.assert_allclose(motion.tau, 8.0 * (0.7 - motion.q) - 2.0 * motion.dq, rtol=0, atol=1e-12)
    np.testing.assert_allclose(0.5 * motion.ddq, 0.7 * motion.tau, rtol=0, atol=1e-12)


def test_a_resting_joint_lets_go_later(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "gain_error", factor=0.5)
    assert let_go(arm) == pytest.approx(0.8, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.8, abs=1.1e-3)


def test_it_is_a_factor_from_none_to_a_hundred(ranges):
    ranges("gain_error", "factor", 0.0, 100.0)
