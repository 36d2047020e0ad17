"""Torque that follows slowly, against the exponential of a matrix."""

import numpy as np
import pytest

from arm.simulation import simulate

INERTIA, KP, KV = 0.5, 8.0, -2.0
DT = 1e-3


@pytest.mark.parametrize(
    ("lag_s", "off"),
    [(0.2, 2e-6), (0.03, 3e-6), (1e-5, 3e-4)],  # a jump that passes in less than a step is up to a sixth of it off
    ids=["slow", "fast", "faster than the step"],
)
def test_a_controller_whose_torque_follows_slowly(wheel, lag_s, off, having, held, linear):
    """Angle, velocity and torque are a linear system of third order."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1 / INERTIA], [-KP / lag_s, KV / lag_s, -1 / lag_s]])
    expected = linear(A, np.array([0.0, 0.0, KP * 0.7 / lag_s]), np.zeros(3), np.arange(0, 1001, 50) * DT)
    motion = simulate(having(wheel, "actuator_lag", time_constant_s=lag_s), held(0.7, 1001), DT, np.zeros(1))
    np.testing.assert_allclose(motion.q[::50, 0], expected[:, 0], rtol=0, atol=off)
    if lag_s > DT:
        np.testing.assert_allclose(motion.ddq[::50, 0], expected[:, 2] / INERTIA, rtol=0, atol=1e-4)


def test_a_torque_that_starts_arrives_by_its_exponential(wheel, having):
    torque = np.where(np.arange(300) > 0, 1.5, 0.0)[:, None]
    motion = simulate(having(wheel, "actuator_lag", time_constant_s=0.05), torque, DT, np.zeros(1), torque=torque)
    t = np.arange(300) * DT - DT / 2  # it grows from nothing over the first step
    arrived = 1.5 * (1.0 - np.exp(-t / 0.05))
    np.testing.assert_allclose(INERTIA * motion.ddq[1:, 0], arrived[1:], rtol=0, atol=1e-4)
    np.testing.assert_array_equal(motion.tau, torque)


def test_no_drive_is_slower_than_half_a_second(ranges):
    ranges("actuator_lag", "time_constant_s", 0.0, 0.5)
