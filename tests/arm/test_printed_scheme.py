"""The paper's own integration: Runge-Kutta on the velocity alone, then Euler on the angle."""

from dataclasses import replace

import numpy as np

from arm.model import Arm, Control, Friction, Joint, Link
from arm.newton_euler import forward_dynamics
from arm.simulation import simulate

BLOCK = Arm("block", (Joint("prismatic", link=Link(2.0)),), (0.0, 0.0, 0.0))
DT = 0.1


def pushed(arm, force, n_sample, **start):
    torque = np.full((n_sample, 1), force)
    return simulate(arm, torque, DT, np.zeros(1), torque=torque, scheme="paper", **start)


def with_friction(*levels):
    return replace(BLOCK, joints=(replace(BLOCK.joints[0], friction=Friction(*levels)),))


def test_under_a_constant_force_angles_run_ahead():
    """Velocities are exact; the angle takes each step with the velocity at its end: ``a h^2 n (n + 1) / 2``."""
    motion, n = pushed(BLOCK, 3.0, 30), np.arange(30)
    np.testing.assert_allclose(motion.dq[:, 0], 1.5 * n * DT, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(motion.q[:, 0], 1.5 * DT**2 * n * (n + 1) / 2.0, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(motion.ddq, 1.5, rtol=1e-15)
    np.testing.assert_array_equal(motion.tau, 3.0)


def test_a_velocity_that_fades_is_followed_to_fourth_order():
    """Each step multiplies by the exponential's series to the fourth power of ``D h / m``."""
    motion, x = pushed(with_friction(8.0), 0.0, 10, dq0=np.array([1.0])), -8.0 * DT / 2.0
    factor = 1.0 + x + x**2 / 2.0 + x**3 / 6.0 + x**4 / 24.0
    np.testing.assert_allclose(motion.dq[:, 0], factor ** np.arange(10), rtol=1e-13)
    np.testing.assert_allclose(np.diff(motion.q[:, 0]), DT * motion.dq[1:, 0], rtol=1e-12)


def test_within_a_step_the_angle_stands_still():
    """Between two samples a spring's force is that of the first one: the step is symplectic Euler's."""
    spring = replace(BLOCK, control=Control("p", (5.0,)))
    motion = simulate(spring, np.full((200, 1), 0.3), DT, np.zeros(1), scheme="paper")
    q, dq = motion.q[:, 0], motion.dq[:, 0]
    np.testing.assert_allclose(dq[1:], dq[:-1] + DT * 5.0 * (0.3 - q[:-1]) / 2.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(q[1:], q[:-1] + DT * dq[1:], rtol=0, atol=1e-13)
    np.testing.assert_allclose(motion.tau[:, 0], 5.0 * (0.3 - q), rtol=0, atol=1e-13)


def test_a_block_sticks_slides_and_is_braked():
    held = pushed(with_friction(0.0, 0.4, 1.0), 0.9, 20)
    np.testing.assert_array_equal(held.q, 0.0)
    for way in (1.0, -1.0):
        slid = pushed(with_friction(0.0, 0.4, 1.0), way * 1.2, 20)
        np.testing.assert_allclose(slid.dq[:, 0], way * 0.4 * np.arange(20) * DT, rtol=1e-12, atol=1e-15)


def test_every_joint_of_a_chain_moves_alike(arm, rubbing):
    """One step by hand, from accelerations of the whole arm with its angles held."""
    smooth, q = rubbing(arm, 0.3, 0.0, 0.0), np.array([0.2, -0.4, 0.9])
    dq, tau = np.array([0.5, -1.0, 0.7]), np.array([3.0, -2.0, 1.0])
    motion = simulate(smooth, np.zeros((2, 3)), 0.02, q, dq, scheme="paper", torque=np.tile(tau, (2, 1)))
    k1 = forward_dynamics(smooth, q, dq, tau)[0]
    k2 = forward_dynamics(smooth, q, dq + 0.01 * k1, tau)[0]
    k3 = forward_dynamics(smooth, q, dq + 0.01 * k2, tau)[0]
    k4 = forward_dynamics(smooth, q, dq + 0.02 * k3, tau)[0]
    after = dq + 0.02 / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    np.testing.assert_allclose(motion.ddq[0], k1, rtol=0, atol=1e-11)
    np.testing.assert_allclose(motion.dq[1], after, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion.q[1], q + 0.02 * after, rtol=0, atol=1e-13)
