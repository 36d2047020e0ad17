"""Runge-Kutta steps that are cut where a joint comes to rest or lets go."""

from dataclasses import replace

import numpy as np
import pytest

from arm.chain import chain_of
from arm.drive import Commands
from arm.drive_state import unchanging
from arm.effects.effect_table import no_effects
from arm.effects.joint_numbers import LIMIT
from arm.integration import engage, runge_kutta_steps
from arm.model import Arm, Friction, Joint, Link
from arm.newton_euler import inverse_dynamics
from arm.simulation import simulate

DT = 1e-3
BLOCK = Arm("block", (Joint("prismatic", friction=Friction(0.0, 0.7), link=Link(2.0)),), (0.0, 0.0, 0.0))


def test_a_block_is_thrown_brakes_and_rests():
    """``v^2 / 2 a`` long, ``v / a`` until it rests, whatever the step; and the target may hold a law too."""
    motion, state = np.empty((4, 100, 1)), np.array([[0.0], [1.0]])
    runge_kutta_steps(
        chain_of(BLOCK), np.zeros((3, 1)), True, np.zeros((100, 1)), 0.1, state, motion, unchanging(1)
    )
    q, dq, ddq, tau = motion[:, :, 0]
    np.testing.assert_allclose(q[-1], 1.0 / 0.7, rtol=1e-12)
    np.testing.assert_allclose(dq, np.maximum(1.0 - 0.35 * 0.1 * np.arange(100), 0.0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(ddq, np.where(dq > 0.0, -0.35, 0.0), rtol=0, atol=1e-12)
    assert not tau.any() and state.tolist() == [[0.0], [1.0]]


def test_what_is_asked_for_is_written_at_every_sample():
    """Of laws (5), (6), (7) with the state at the sample; of a given torque, itself."""
    law, drive = np.array([[8.0], [-2.0], [-0.5]]), np.linspace(0.0, 1.0, 20)[:, None]
    motion, state = np.empty((4, 20, 1)), np.array([[0.3], [0.1]])
    runge_kutta_steps(chain_of(BLOCK), law, False, drive, 0.01, state, motion, unchanging(1))
    q, dq, ddq, tau = motion
    np.testing.assert_allclose(tau, 8.0 * (drive - q) - 2.0 * dq - 0.5 * ddq, rtol=0, atol=1e-12)
    np.testing.assert_allclose(2.0 * ddq + 0.7 * np.sign(dq), tau, rtol=0, atol=1e-12)
    runge_kutta_steps(chain_of(BLOCK), 0.0 * law, True, drive, 0.01, state, motion, unchanging(1))
    np.testing.assert_array_equal(motion[3], drive)


def test_a_step_is_that_of_runge_and_kutta(random_arm):
    """One smooth step against scipy's, to the fifth power of its length."""
    arm = random_arm(np.random.default_rng(5), 2, friction=False)
    torque = np.zeros((2, 2))
    errors = []
    for step in (0.04, 0.02):
        one = simulate(arm, torque, step, np.full(2, 0.3), np.array([0.5, -0.4]), torque=torque)
        fine = simulate(arm, np.zeros((65, 2)), step / 64, one.q[0], one.dq[0], torque=np.zeros((65, 2)))
        errors.append(np.abs(one.q[1] - fine.q[-1]).max())
    assert 24.0 < errors[0] / errors[1] < 44.0


def test_drives_that_let_go_have_no_limit_left():
    table, commands = no_effects(2), Commands(np.zeros((3, 2)), False, np.zeros((1, 2)), DT, 0.0)
    now = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [1.0, 0.0]])
    engage(commands, table, now, np.array([7.0, 8.0]))
    np.testing.assert_array_equal(commands.law, now[:3])
    assert table.numbers[LIMIT].tolist() == [7.0, 0.0]


@pytest.mark.parametrize("name", ["torque_saturation", "load_friction", "gain_error", "actuator_lag"])
def test_law_6_feeds_back_the_acceleration_that_comes_of_it(arm, name, having):
    """However its torque depends on the acceleration, the one that is found obeys the equations."""
    numbers = {
        "torque_saturation": {"limit_N_m": 8.0},
        "load_friction": {"coefficient": 0.3},
        "gain_error": {"factor": 0.7},
        "actuator_lag": {"time_constant_s": 0.02},
    }[name]
    pda = replace(arm, control=replace(arm.control, law="pda", ka=(-1.0, -2.0, -0.4)))
    motion = simulate(having(pda, name, **numbers), np.tile([1.0, -0.8, 0.5], (800, 1)), DT, np.full(3, 0.2))
    moving = np.all(motion.dq != 0.0, axis=1)
    given = inverse_dynamics(arm, motion.q, motion.dq, motion.ddq)[moving]
    asked = motion.tau[moving]
    np.testing.assert_allclose(given[:, 1:], asked[:, 1:], rtol=0, atol=1e-9)
    if name == "torque_saturation":
        assert np.abs(asked[:, 0]).max() > 9.0
        np.testing.assert_allclose(given[:, 0], np.clip(asked[:, 0], -8.0, 8.0), rtol=0, atol=1e-9)
    elif name == "load_friction":
        rubbed = asked[:, 0] - 0.3 * np.abs(asked[:, 0]) * np.sign(motion.dq[moving, 0])
        np.testing.assert_allclose(given[:, 0], rubbed, rtol=0, atol=1e-9)
    elif name == "gain_error":
        np.testing.assert_allclose(given[:, 0], 0.7 * asked[:, 0], rtol=0, atol=1e-9)
    else:  # T x' = u - x
        slope = np.gradient(given[:, 0], DT)[5:-5]
        np.testing.assert_allclose(0.02 * slope, (asked - given)[5:-5, 0], rtol=0, atol=0.02 * np.abs(asked).max())


def test_friction_with_effects_keeps_the_order_of_the_integration(arm, having):
    """Stops and starts are found to the instant, so a step of half the length is 16 times better."""
    rough = having(arm, "stribeck", amplitude_N_m=0.3, velocity_rad_s=0.5)
    rough = having(
        having(rough, "quadratic_drag", joint=2, drag_N_m_s2=0.1), "coulomb_asymmetry", difference_N_m=0.1
    )
    runs = [
        simulate(rough, np.tile([0.6, -0.3, 0.2], (2500 * 2**k // 10 + 1, 1)), 1e-2 / 2**k, np.full(3, 0.2))
        for k in range(5)
    ]
    assert np.count_nonzero(np.diff(runs[-1].dq == 0.0, axis=0)) >= 2
    errors = np.array([np.abs(run.q - runs[-1].q[:: 2 ** (4 - k)]).max() for k, run in enumerate(runs[:-1])])
    assert np.all(errors[:-1] / errors[1:] > 10.0)
