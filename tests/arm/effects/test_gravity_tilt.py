"""A plane of motion that is not level."""

import numpy as np

from arm.effects.effect_table import changed
from arm.model import Arm, Joint, Link
from arm.newton_euler import bias_torque


def test_gravity_gets_a_part_along_the_plane(arm, having):
    tilted = changed(having(arm, "gravity_tilt", gx_m_s2=0.31, gy_m_s2=-0.12))
    np.testing.assert_allclose(tilted.gravity_m_s2, np.array(arm.gravity_m_s2) + [0.31, -0.12, 0.0], rtol=1e-15)


def test_a_level_rod_hangs_by_its_weight_along_the_plane(having):
    """Weight times the arm of gravity: the centre is at 0.3 m along x, so a pull along -y asks for torque."""
    rod = Arm("rod", (Joint(link=Link(2.0, (0.3, 0.0, 0.0))),))
    rod = having(rod, "gravity_tilt", gx_m_s2=0.0, gy_m_s2=-0.5)
    still = np.zeros((2, 1))
    torque = bias_torque(changed(rod), np.array([[0.0], [np.pi / 2.0]]), still)
    np.testing.assert_allclose(torque[:, 0], [2.0 * 0.3 * 0.5, 0.0], atol=1e-12)


def test_what_it_may_be(ranges):
    ranges("gravity_tilt", "gx_m_s2", -20.0, 20.0, gy_m_s2=0.0)
    ranges("gravity_tilt", "gy_m_s2", -20.0, 20.0, gx_m_s2=0.0)
