"""Torque that comes late, against equations with delay that are solved from one delay to the next."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from arm.simulation import simulate

INERTIA, KP, KV = 0.5, 8.0, -2.0
DT = 1e-3


def under_delay(delay_s, target, seconds):
    """Return the wheel's angle at the end of every delay, solved from one to the next."""
    pieces = [lambda _: np.zeros(2)]  # it rested, and nothing was asked for
    state, q = np.zeros(2), [0.0]
    for k in range(round(seconds / delay_s)):
        past = pieces[-1]

        def rate(t, x, past=past, first=k == 0):
            then = past(t - delay_s)
            u = 0.0 if first else KP * (target - then[0]) + KV * then[1]
            return [x[1], u / INERTIA]

        span = (k * delay_s, (k + 1) * delay_s)
        run = solve_ivp(rate, span, state, dense_output=True, rtol=1e-11, atol=1e-12, max_step=delay_s / 5)
        state = run.y[:, -1]
        pieces.append(run.sol)
        q.append(state[0])
    return np.array(q)


@pytest.mark.parametrize(
    ("delay_s", "seconds"), [(0.02, 1.0), (0.0005, 0.1)], ids=["of many steps", "of half a step"]
)
def test_a_controller_whose_torque_comes_late(wheel, delay_s, seconds, having, held):
    n_sample = round(seconds / DT) + 1
    motion = simulate(having(wheel, "actuator_delay", delay_s=delay_s), held(0.7, n_sample), DT, np.zeros(1))
    stride = max(1, round(delay_s / DT))
    expected = under_delay(delay_s, 0.7, seconds)[:: max(1, round(stride * DT / delay_s))]
    np.testing.assert_allclose(motion.q[::stride, 0], expected, rtol=0, atol=2e-6)
    early = simulate(wheel, held(0.7, n_sample), DT, np.zeros(1))
    assert np.abs(motion.q - early.q).max() > 100 * 2e-6
    np.testing.assert_allclose(motion.tau, KP * (0.7 - motion.q) + KV * motion.dq, rtol=0, atol=1e-12)


def test_a_delay_is_followed_to_second_order(wheel, having, held):
    late = having(wheel, "actuator_delay", delay_s=0.0137)
    runs = [simulate(late, held(0.7, 500 * 2**k + 1), 2e-3 / 2**k, np.zeros(1)).q[:: 2**k] for k in range(5)]
    errors = np.array([np.abs(run[::10] - runs[-1][::10]).max() for run in runs[:-1]])
    assert errors[0] < 2e-5 and np.all(errors[:-2] / errors[1:-1] > 3.0)


def test_a_given_torque_that_comes_late(wheel, having):
    """It runs straight between samples, so the motion is exact but where the line bends within a step."""
    rng = np.random.default_rng(0)
    torque = np.cumsum(rng.normal(size=(300, 1)), axis=0) * 0.1
    torque[0] = 0.0
    plain = simulate(wheel, torque, DT, np.zeros(1), torque=torque)
    late = simulate(having(wheel, "actuator_delay", delay_s=7 * DT), torque, DT, np.zeros(1), torque=torque)
    np.testing.assert_allclose(late.q[7:], plain.q[:-7], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(late.q[:8], 0.0)
    np.testing.assert_array_equal(late.tau, torque)
    between = simulate(having(wheel, "actuator_delay", delay_s=7.5 * DT), torque, DT, np.zeros(1), torque=torque)
    moved = (plain.q[:-8] + plain.q[1:-7]) / 2
    np.testing.assert_allclose(between.q[8:], moved, rtol=0, atol=2e-6)


def test_a_delay_is_none_to_a_second(ranges):
    ranges("actuator_delay", "delay_s", 0.0, 1.0)
