"""Play and twist: the motor's side against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.backlash import CROSSING_S
from arm.model import Control
from arm.simulation import GearedMotion, simulate, tip_of
from limbcal.errors import ConfigError

INERTIA, KP, KV = 0.5, 8.0, -2.0
DT = 1e-3


@pytest.mark.parametrize(
    ("stiffness", "damping"), [(60.0, 2.0), (60.0, 0.0), (2000.0, 0.5)], ids=["soft", "undamped", "stiff"]
)
def test_a_controller_behind_a_spring(wheel, stiffness, damping, having, held, linear):
    """Link and twist are a linear system of third order: ``k x + d x' = kp (ref - q - x) + kv (dq + x')``."""
    motion = simulate(
        having(wheel, "joint_elasticity", stiffness_N_m_rad=stiffness, damping_N_m_s=damping),
        held(0.7, 2001),
        DT / 2,
        np.zeros(1),
    )
    assert isinstance(motion, GearedMotion)
    twisting = np.array([-KP, KV, -(stiffness + KP)]) / (damping - KV)
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], twisting])
    A[1] = np.array([0.0, 0.0, stiffness]) / INERTIA + damping / INERTIA * twisting
    b = np.array([0.0, damping / INERTIA, 1.0]) * KP * 0.7 / (damping - KV)
    torque = KP * 0.7  # at the first instant the spring is taken to be twisted by the torque asked for
    start = np.array([-torque / stiffness, 0.0, torque / stiffness])
    expected = linear(A, b, start, np.arange(0, 2001, 100) * DT / 2)
    np.testing.assert_allclose(motion.link_q[::100, 0], expected[:, 0], rtol=0, atol=2e-5)
    np.testing.assert_allclose(motion.q[::100, 0], expected[:, 0] + expected[:, 2], rtol=0, atol=2e-5)
    np.testing.assert_allclose(motion.tau, KP * (0.7 - motion.q) + KV * motion.dq, rtol=0, atol=1e-10)


def test_the_tip_goes_with_the_link(wheel, having):
    arm = having(wheel, "joint_elasticity", stiffness_N_m_rad=80.0, damping_N_m_s=0.4)
    arm = replace(arm, joints=(replace(arm.joints[0], a_m=0.5),))
    torque = 3.0 * np.sin(np.arange(300) * DT)[:, None]
    motion = simulate(arm, torque, DT, np.zeros(1), torque=torque)
    assert isinstance(motion, GearedMotion)
    expected = 0.5 * np.column_stack([np.cos(motion.link_q), np.sin(motion.link_q), 0.0 * motion.link_q])
    np.testing.assert_allclose(tip_of(arm, motion), expected, rtol=0, atol=1e-12)


def test_a_slow_torque_twists_by_its_share_of_the_stiffness(wheel, having):
    torque = 3.0 * np.sin(np.arange(3000) * DT)[:, None]
    arm = having(wheel, "joint_elasticity", stiffness_N_m_rad=80.0, damping_N_m_s=0.4)
    motion = simulate(arm, torque, DT, np.zeros(1), torque=torque)
    np.testing.assert_allclose(motion.q - motion.link_q, torque / 80.0, rtol=0, atol=3.1 * 0.4 / 80.0**2)
    np.testing.assert_allclose(INERTIA * motion.link_ddq, torque, rtol=0, atol=1e-12)


def test_the_motors_side_leads_by_half_the_gap(wheel, having):
    torque = np.where(np.arange(2000) % 1000 < 500, 0.4, -0.4)[:, None]
    motion = simulate(having(wheel, "backlash", gap_rad=0.01), torque, DT, np.zeros(1), torque=torque)
    lead = (motion.q - motion.link_q)[:, 0]
    pushed_long = np.arange(2000) % 500 > 8 * CROSSING_S / DT
    np.testing.assert_allclose(lead[pushed_long], 0.005 * np.sign(torque[pushed_long, 0]), rtol=0, atol=1e-5)
    assert np.abs(lead).max() <= 0.005 + 1e-12
    np.testing.assert_allclose(INERTIA * motion.link_ddq, torque, rtol=0, atol=1e-12)


def test_in_the_gap_nothing_is_transmitted(wheel, having):
    """A motor without inertia crosses it such that its controller asks for nothing."""
    t = np.arange(6000) * DT
    motion = simulate(having(wheel, "backlash", gap_rad=0.2), np.sin(3.0 * t)[:, None], DT, np.zeros(1))
    lead = (motion.q - motion.link_q)[:, 0]
    inside = np.abs(lead) < 0.09
    assert 0.05 < np.mean(inside[1000:]) < 0.9
    np.testing.assert_allclose(motion.link_ddq[inside], 0.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(motion.tau[inside], 0.0, rtol=0, atol=1e-9)
    outside = np.abs(motion.tau[:, 0]) > 0.1
    np.testing.assert_allclose(lead[outside], 0.1 * np.sign(motion.tau[outside, 0]), rtol=0, atol=4e-3)


def test_play_and_twist_together(wheel, having):
    both = having(wheel, "backlash", gap_rad=0.02)
    both = having(both, "joint_elasticity", stiffness_N_m_rad=50.0, damping_N_m_s=0.2)
    torque = np.where(np.arange(2000) < 1000, 0.5, -0.5)[:, None]
    motion = simulate(both, torque, DT, np.zeros(1), torque=torque)
    settled = np.arange(2000) % 1000 > 200
    lead = 0.01 * np.sign(torque) + torque / 50.0
    np.testing.assert_allclose((motion.q - motion.link_q)[settled], lead[settled], rtol=0, atol=1e-6)


def test_velocity_and_acceleration_are_those_of_the_angle(wheel, having):
    t = np.arange(3000) * DT
    arm = having(wheel, "joint_elasticity", stiffness_N_m_rad=60.0, damping_N_m_s=1.0)
    motion = simulate(arm, np.sin(3.0 * t)[:, None], DT, np.zeros(1))
    for slope, of in ((motion.dq, motion.q), (motion.ddq, motion.dq), (motion.link_dq, motion.link_q)):
        np.testing.assert_allclose(np.gradient(of[:, 0], DT)[2:-2], slope[2:-2, 0], rtol=0, atol=1e-2)


def test_what_does_not_go_together_is_refused(wheel, having, held):
    law6 = replace(having(wheel, "backlash", gap_rad=0.1), control=Control("pda", (8.0,), (-2.0,), (-0.1,)))
    with pytest.raises(
        ConfigError, match="control.law is 'pda', which does not go with backlash or joint_elasticity"
    ):
        simulate(law6, held(0.1, 10), DT, np.zeros(1))
    with pytest.raises(ConfigError, match="the paper's scheme knows no effects; expected scheme 'rk4'"):
        simulate(having(wheel, "backlash", gap_rad=0.1), held(0.1, 10), DT, np.zeros(1), scheme="paper")
