"""A transmission that twists, against the exponential of a matrix."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.bench import Bench, motions
from arm.counts import COUNT_M_S2
from arm.simulation import GearedMotion, simulate, tip_of

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


def test_velocity_and_acceleration_are_those_of_the_angle(wheel, having):
    t = np.arange(3000) * DT
    arm = having(wheel, "joint_elasticity", stiffness_N_m_rad=60.0, damping_N_m_s=1.0)
    motion = simulate(arm, np.sin(3.0 * t)[:, None], DT, np.zeros(1))
    for slope, of in ((motion.dq, motion.q), (motion.ddq, motion.dq), (motion.link_dq, motion.link_q)):
        np.testing.assert_allclose(np.gradient(of[:, 0], DT)[2:-2], slope[2:-2, 0], rtol=0, atol=1e-2)


def test_sensors_ride_on_links_and_not_on_motors(arm, having, swung, read):
    arm = having(arm, "joint_elasticity", joint=2, stiffness_N_m_rad=100.0, damping_N_m_s=1.0)
    motion = swung(arm)
    assert isinstance(motion, GearedMotion) and np.abs(motion.q - motion.link_q).max() > 0.02
    expected = specific_force(arm, motion.link_q, motion.link_dq, motion.link_ddq)
    np.testing.assert_allclose(read(arm, [motion]), expected, rtol=0, atol=COUNT_M_S2)


def test_the_bench_keeps_links_and_motors_apart(arm, having):
    bench = Bench(rate_hz=2000.0, trial_s=0.6, rest_s=0.1, learning=2, evaluating=2)
    arm = having(arm, "joint_elasticity", stiffness_N_m_rad=200.0, damping_N_m_s=1.0)
    motion = next(motions(arm, bench, 3))
    assert isinstance(motion, GearedMotion) and len(motion.link_q) == len(motion.q) == 1200
    lead = (motion.q - motion.link_q)[:, 0]
    np.testing.assert_allclose(lead[-1], motion.tau[-1, 0] / 200.0, rtol=0.2)


def test_what_it_may_be(ranges, accepts):
    ranges("joint_elasticity", "stiffness_N_m_rad", 1.0, 1e7, damping_N_m_s=0.0)
    ranges("joint_elasticity", "damping_N_m_s", 0.0, 1e4, stiffness_N_m_rad=1.0)
    assert accepts("joint_elasticity", stiffness_N_m_rad=np.inf, damping_N_m_s=0.0)
