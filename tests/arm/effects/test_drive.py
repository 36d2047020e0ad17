"""Delay, lag, limits and gains against closed forms and scipy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from arm.model import Control
from arm.newton_euler import bias_torque, inverse_dynamics, mass_matrix
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


@pytest.mark.parametrize("delay_s", [0.02, 0.0005], ids=["of many steps", "of half a step"])
def test_a_controller_whose_torque_comes_late(wheel, delay_s, having, held):
    motion = simulate(having(wheel, "actuator_delay", delay_s=delay_s), held(0.7, 1001), DT, np.zeros(1))
    stride = max(1, round(delay_s / DT))
    expected = under_delay(delay_s, 0.7, 1.0)[:: max(1, round(stride * DT / delay_s))]
    np.testing.assert_allclose(motion.q[::stride, 0], expected, rtol=0, atol=2e-6)
    early = simulate(wheel, held(0.7, 1001), DT, np.zeros(1))
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


def test_lag_delay_and_gain_together(wheel, having):
    """A given sine, so long that what was before has faded, comes through with its gain and its phase."""
    both = having(having(wheel, "actuator_delay", delay_s=0.0123), "actuator_lag", time_constant_s=0.05)
    both = having(both, "gain_error", factor=0.8)
    t = np.arange(4001) * DT
    torque = np.sin(9.0 * t)[:, None]
    motion = simulate(both, torque, DT, np.zeros(1), torque=torque)
    passed = 0.8 * np.exp(1j * 9.0 * (t - 0.0123)) / (1 + 9.0j * 0.05)
    np.testing.assert_allclose(INERTIA * motion.ddq[2000:, 0], passed.imag[2000:], rtol=0, atol=2e-5)


def test_an_arm_that_rests_has_been_held_before(held_arm, having):
    """Late drives hold the arm where its controller balances gravity: nothing moves until a new target arrives."""
    arm, q0, target = held_arm
    for name, number in (("actuator_delay", "delay_s"), ("actuator_lag", "time_constant_s")):
        late = having(having(arm, name, joint=1, **{number: 0.1}), name, joint=2, **{number: 0.1})
        motion = simulate(late, np.tile(target, (200, 1)), DT, q0)
        np.testing.assert_allclose(motion.q, np.tile(q0, (200, 1)), rtol=0, atol=1e-9)
        moved = simulate(late, np.tile(target + 0.3, (200, 1)), DT, q0)
        early = slice(0, 95) if name == "actuator_delay" else slice(0, 1)
        np.testing.assert_allclose(moved.q[early], np.tile(q0, (200, 1))[early], rtol=0, atol=1e-9)
        assert np.abs(moved.q[-1] - q0).max() > 1e-3


@pytest.fixture
def held_arm(arm, rubbing):
    """Return an arm without friction, an angle, and the target with which its controller holds it there."""
    smooth = rubbing(replace(arm, joints=arm.joints[1:], sensors=(), tip=None), 0.1, 0.0, 0.0)
    smooth = replace(smooth, control=Control("pd", arm.control.kp[1:], arm.control.kv[1:]))
    q0 = np.array([0.4, -0.3])
    return smooth, q0, q0 + bias_torque(smooth, q0[None], np.zeros((1, 2)))[0] / np.array(smooth.control.kp)


def test_a_motor_gives_no_more_than_its_limit(wheel, having, held):
    weak = having(wheel, "torque_saturation", limit_N_m=1.5)

    def rate(_, x):
        return [x[1], np.clip(KP * (0.9 - x[0]) + KV * x[1], -1.5, 1.5) / INERTIA]

    run = solve_ivp(rate, (0.0, 2.0), [0.0, 0.0], rtol=1e-10, atol=1e-12, max_step=DT, t_eval=np.arange(2001) * DT)
    motion = simulate(weak, held(0.9, 2001), DT, np.zeros(1))
    np.testing.assert_allclose(motion.q[:, 0], run.y[0], rtol=0, atol=1e-6)
    assert np.abs(motion.tau).max() > 4.0  # what is asked for is told, not what is given
    assert np.abs(INERTIA * motion.ddq).max() <= 1.5 + 1e-12


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


def test_a_rotor_is_a_mass_on_the_diagonal(arm, having):
    having_rotor = having(arm, "rotor_inertia", inertia_kg_m2=0.4)
    ref = np.tile([1.0, -0.8, 0.5], (2, 1))
    plain, geared = (simulate(each, ref, DT, np.full(3, 0.2)) for each in (arm, having_rotor))
    M = mass_matrix(arm, plain.q[:1])[0]
    np.testing.assert_allclose((M + np.diag([0.4, 0.0, 0.0])) @ geared.ddq[0], M @ plain.ddq[0], rtol=0, atol=1e-9)
