"""Play in the transmission: the motor leads by half the gap, and crosses it while nothing is transmitted."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.backlash import CROSSING_S
from arm.model import Control
from arm.simulation import GearedMotion, simulate
from limbcal.errors import ConfigError

INERTIA = 0.5
DT = 1e-3


def test_the_motors_side_leads_by_half_the_gap(wheel, having):
    torque = np.where(np.arange(2000) % 1000 < 500, 0.4, -0.4)[:, None]
    motion = simulate(having(wheel, "backlash", gap_rad=0.01), torque, DT, np.zeros(1), torque=torque)
    lead = (motion.q - motion.link_q)[:, 0]
    pushed_long = np.arange(2000) % 500 > 8 * CROSSING_S / DT
    np.testing.assert_allclose(lead[pushed_long], 0.005 * np.sign(torque[pushed_long, 0]), rtol=0, atol=1e-5)
    assert np.abs(lead).max() <= 0.005 + 1e-12
    np.testing.assert_allclose(INERTIA * motion.link_ddq, torque, rtol=0, atol=1e-12)


def test_a_free_motor_crosses_within_milliseconds(wheel, having):
    """From one side of the gap to the other it tends with a time constant of 2 ms."""
    torque = np.where(np.arange(400) < 200, 0.4, -0.4)[:, None]
    motion = simulate(having(wheel, "backlash", gap_rad=0.01), torque, DT / 10, np.zeros(1), torque=torque)
    lead = (motion.q - motion.link_q)[200:, 0]
    fallen = -np.log((lead + 0.005) / (lead[0] + 0.005))
    np.testing.assert_allclose(np.diff(fallen[:100]), DT / 10 / 0.002, rtol=1e-9)


def test_in_the_gap_nothing_is_transmitted(wheel, having):
    """A motor without inertia crosses it such that its controller asks for nothing."""
    t = np.arange(6000) * DT
    motion = simulate(having(wheel, "backlash", gap_rad=0.2), np.sin(3.0 * t)[:, None], DT, np.zeros(1))
    assert isinstance(motion, GearedMotion)
    lead = (motion.q - motion.link_q)[:, 0]
    inside = np.abs(lead) < 0.09
    assert 0.05 < np.mean(inside[1000:]) < 0.9
    np.testing.assert_allclose(motion.link_ddq[inside], 0.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(motion.tau[inside], 0.0, rtol=0, atol=1e-9)
    outside = np.abs(motion.tau[:, 0]) > 0.1
    np.testing.assert_allclose(lead[outside], 0.1 * np.sign(motion.tau[outside, 0]), rtol=0, atol=4e-3)


def test_what_does_not_go_together_is_refused(wheel, having, held):
    law6 = replace(having(wheel, "backlash", gap_rad=0.1), control=Control("pda", (8.0,), (-2.0,), (-0.1,)))
    with pytest.raises(
        ConfigError, match="control.law is 'pda', which does not go with backlash or joint_elasticity"
    ):
        simulate(law6, held(0.1, 10), DT, np.zeros(1))
    with pytest.raises(ConfigError, match="the paper's scheme knows no effects; expected scheme 'rk4'"):
        simulate(having(wheel, "backlash", gap_rad=0.1), held(0.1, 10), DT, np.zeros(1), scheme="paper")


def test_a_gap_is_none_to_a_radian(ranges):
    ranges("backlash", "gap_rad", 0.0, 1.0)
