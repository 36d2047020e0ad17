"""One tick: steps against closed forms and scipy, the account of energy by hand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from arm.model import Arm, Control, Effect, Friction, Joint, Link
from playback.touch.coupling import (
    ARM,
    BRAKED,
    CREDIT,
    DEVICE,
    HAND,
    INJECTED,
    INTERVAL,
    LIMIT,
    STIFFNESS,
    STORED,
    TURN_DEVICE,
    TURN_LIMIT,
    TURN_STIFFNESS,
    WALL_LIMIT,
    WALL_STIFFNESS,
)
from playback.touch.grip import Hand
from playback.touch.limit import Coupling
from playback.touch.memory import Parts
from playback.touch.tick import (
    begin_step,
    brake,
    come_to_rest,
    feel,
    first_reversal,
    hear,
    runge_kutta_state,
    tick,
)
from playback.touch.touched_arm import TouchedArm

T, INERTIA, MASS, REACH = 1e-3, 0.5, 2.0, 0.3


def pendulum(friction: Friction | None = None, gravity: float = 0.0, **changes: object) -> Arm:
    """Return one joint with a level axis, whose link hangs out along its x axis; free to move."""
    link = Link(MASS, (REACH, 0.0, 0.0), (0.1, 0.1, INERTIA, 0.0, 0.0, 0.0))
    joint = Joint(a_m=0.4, link=link, friction=friction or Friction())
    arm = Arm("pendulum", (joint,), gravity_m_s2=(gravity, 0.0, 0.0), control=Control("measured"))
    return replace(arm, **changes)


def touched(arm: Arm, q: float = 0.0, dq: float = 0.0) -> TouchedArm:
    one = TouchedArm(arm, np.array([q]), T, Coupling())
    one.state[1] = dq
    return one


@pytest.fixture
def parts() -> Parts:
    """Return an arm that is held at its tip, with numbers that are easily reckoned with."""
    one = touched(pendulum())
    one.take(one.tip, Hand(one.touched_point(one.tip)))
    x = one.memory.parts.touch.numbers
    x[:] = 0.0
    x[STIFFNESS], x[LIMIT], x[TURN_LIMIT] = 100.0, 50.0, 5.0
    x[DEVICE], x[TURN_DEVICE], x[INTERVAL] = 3.0, 0.5, 0.01
    one.memory.parts.touch.wall[:] = 0.0, 1.0, 0.0, -10.0
    return one.memory.parts


def test_a_pendulum_swings_as_scipy_says() -> None:
    one, n = touched(pendulum(gravity=9.81), q=2.0, dq=-1.0), 500
    tick(*one.memory.arrays, n, False)
    weight = MASS * REACH * 9.81 / INERTIA
    fine = {"rtol": 1e-11, "atol": 1e-12}
    path = solve_ivp(lambda _, y: [y[1], -weight * np.sin(y[0])], (0.0, n * T), [2.0, -1.0], **fine)
    np.testing.assert_allclose(one.state[:2, 0], path.y[:, -1], rtol=0, atol=1e-8)
    assert one.state[2, 0] == pytest.approx(-weight * np.sin(path.y[0, -1]), rel=0.02)
    assert one.memory.parts.clock[0] == pytest.approx(n * T)


@pytest.mark.parametrize("at_once", [1, 300])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_friction_stops_a_joint_where_its_energy_is_used_up(side: float, at_once: int) -> None:
    one, torque, speed = touched(pendulum(Friction(0.0, 0.4, 0.6)), dq=side * 0.1003), 0.4, 0.1003
    for _ in range(300 // at_once):
        tick(*one.memory.arrays, at_once, False)
    assert one.state[1, 0] == 0.0  # it sticks from then on
    assert side * one.state[0, 0] == pytest.approx(INERTIA * speed**2 / (2.0 * torque), rel=1e-6)


def test_the_hands_work_is_the_arms_energy() -> None:
    one = touched(pendulum(), q=0.3)
    start = one.touched_point(one.tip)
    one.take(one.tip, Hand(start))
    for k in range(200):
        one.step(1, Hand(start + [0.0, 2e-4 * k, 0.0]))
    kinetic = 0.5 * INERTIA * one.state[1, 0] ** 2
    assert kinetic > 1e-3
    assert one.energy()["arm"] == pytest.approx(kinetic, rel=1e-6)


def test_a_stretch_is_a_taylor_polynomial_of_fourth_degree() -> None:
    """For an oscillator Runge and Kutta's step is that of the exponential, exactly."""
    q, dq, h, rates = np.array([0.3, -0.2]), np.array([1.0, 2.0]), 0.1, np.array([4.0, 9.0])
    slopes, after = np.zeros((2, 4, 2)), np.zeros((3, 2))
    for stage in range(4):
        runge_kutta_state(q, dq, slopes, stage, h, after)
        slopes[1, stage] = -rates * after[0]
    runge_kutta_state(q, dq, slopes, 4, h, after)
    for i, rate in enumerate(rates):
        A = h * np.array([[0.0, 1.0], [-rate, 0.0]])
        step = np.eye(2) + A @ (np.eye(2) + A / 2.0 @ (np.eye(2) + A / 3.0 @ (np.eye(2) + A / 4.0)))
        np.testing.assert_allclose(after[:2, i], step @ [q[i], dq[i]], rtol=1e-12)


def test_the_first_joint_to_turn_round_ends_a_stretch() -> None:
    room = TouchedArm(two_joints(), np.zeros(2), T, Coupling()).memory.parts.room
    dq, mode = np.array([0.3, -0.2]), np.array([1.0, -1.0])
    assert first_reversal(mode, dq, np.array([-0.1, 0.2]), room) == pytest.approx(0.5)
    assert first_reversal(mode, dq, np.array([-0.1, -0.1]), room) == pytest.approx(0.75)
    assert first_reversal(mode, dq, np.array([0.1, 0.0]), room) == 1.0
    room.directed[:] = False
    assert first_reversal(mode, dq, np.array([-0.1, 0.2]), room) == 1.0


def two_joints() -> Arm:
    one = pendulum(Friction(0.0, 0.4, 0.6))
    return replace(one, joints=one.joints * 2)


@pytest.mark.parametrize(
    ("again", "after", "expected"),
    [
        (False, [0.2, -1e-4], [0.2, -1e-4]),
        (False, [-0.2, 1e-4], [0.0, 0.0]),
        (True, [0.2, -1e-4], [0.2, 0.0]),
        (True, [-0.2, -3e-4], [0.0, -3e-4]),
    ],
)
def test_what_has_come_to_rest_is_stopped(again: bool, after: list[float], expected: list[float]) -> None:
    room = TouchedArm(two_joints(), np.zeros(2), T, Coupling()).memory.parts.room
    now = np.array(after)
    come_to_rest(again, np.array([1.0, -1.0]), np.array([0.3, -0.2]), now, room)
    np.testing.assert_array_equal(now, expected)


def test_a_joint_at_rest_or_without_friction_is_not_stopped() -> None:
    room = TouchedArm(two_joints(), np.zeros(2), T, Coupling()).memory.parts.room
    room.directed[1] = False
    now = np.array([1e-4, 1e-4])
    come_to_rest(True, np.array([0.0, 1.0]), np.array([0.3, 0.2]), now, room)
    np.testing.assert_array_equal(now, [1e-4, 1e-4])


@pytest.mark.parametrize("heard", [True, False])
def test_what_the_hand_did_since_is_put_down(parts: Parts, heard: bool) -> None:
    touch, account = parts.touch, parts.touch.account
    account[:] = 0.0
    account[STORED] = 0.25
    touch.path[0] += [0.1, 0.0, 0.0]  # it was stretched by a tenth of a metre: half a joule
    touch.path[1] = touch.path[0] + [0.02, 0.0, -0.01]
    touch.sent[:] = [[-10.0, 0.0, 4.0], [0.0, 0.0, 2.0]]
    touch.twist[:] = 0.0, 0.0, 0.1
    hear(touch, heard)
    assert account[INJECTED] == pytest.approx(0.25)
    assert account[HAND] == pytest.approx(0.24 - 0.2 if heard else 0.0)
    assert account[CREDIT] == pytest.approx((3.0 * 5e-4 + 0.5 * 0.01) / 0.01 if heard else 0.0)


@pytest.mark.parametrize("heard", [True, False])
def test_the_hand_feels_spring_and_wall(parts: Parts, heard: bool) -> None:
    touch = parts.touch
    touch.path[1] = touch.path[0] + [0.1, 0.0, 0.0]
    touch.numbers[TURN_STIFFNESS], touch.numbers[WALL_STIFFNESS], touch.numbers[WALL_LIMIT] = 2.0, 200.0, 30.0
    touch.wall[:] = 0.0, 1.0, 0.0, 0.05  # the hand is 5 cm deep in it
    touch.twist[:] = 0.0, 0.0, 0.4
    touch.account[HAND] = 100.0  # nothing is to be braked
    touch.sent[:] = 9.0
    feel(parts, heard)
    np.testing.assert_allclose(touch.felt, [[-10.0, 10.0, 0.0], [0.0, 0.0, -0.8]], atol=1e-9)
    assert touch.account[STORED] == pytest.approx(0.5 + 0.16 + 0.25)
    np.testing.assert_array_equal(touch.path[0], touch.path[1])
    np.testing.assert_array_equal(touch.twist, 0.0)
    c, s = np.cos(0.4), np.sin(0.4)
    np.testing.assert_allclose(touch.frame, [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], atol=1e-12)
    np.testing.assert_array_equal(touch.sent, touch.felt if heard else 9.0)
    touch.numbers[WALL_LIMIT] = 4.0
    feel(parts, heard)
    np.testing.assert_allclose(touch.felt[0], [-10.0, 4.0, 0.0], atol=1e-9)


def test_a_hand_that_holds_nothing_feels_nothing(parts: Parts) -> None:
    touch = parts.touch
    touch.path[1], touch.felt[:], touch.joint[0], touch.account[STORED] = 5.0, 7.0, -1, 3.0
    feel(parts, False)
    np.testing.assert_array_equal(touch.felt, 0.0)
    np.testing.assert_array_equal(touch.path[0], 5.0)
    assert touch.account[STORED] == 0.0


@pytest.mark.parametrize(
    ("short", "resists"),
    [(0.0, 0.0), (1e-14, 0.0), (0.002, 0.4), (0.004, 0.8), (1.0, 3.0)],
    ids=["even", "but for rounding", "a little", "more", "more than the device takes"],
)
def test_energy_that_is_missing_is_taken_from_the_hand(parts: Parts, short: float, resists: float) -> None:
    """Within one tick of 10 ms a damper of 0.4 N s/m takes 2 mJ at half a metre a second."""
    touch = parts.touch
    touch.account[:] = 0.0
    touch.account[HAND], touch.account[INJECTED], touch.account[CREDIT] = 0.5, 0.25, 0.25
    touch.account[ARM], touch.account[STORED] = 0.7, 0.3 + short
    touch.felt[:] = [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    touch.seen[:] = [[0.0, -0.5 * np.sqrt(2.0), 0.5 * np.sqrt(2.0)], [0.0, 0.0, 0.0]]
    brake(touch)
    square = float(touch.seen[0] @ touch.seen[0])
    expected = min(short / (0.01 * square), 3.0) if resists else 0.0
    np.testing.assert_allclose(touch.felt[0], [1.0, 0.0, 0.0] - expected * touch.seen[0], rtol=1e-9)
    assert expected == pytest.approx(resists / (2.0 if 0.0 < short < 1.0 else 1.0), rel=1e-6)
    assert touch.account[BRAKED] == (1.0 if resists else 0.0)


def test_braking_keeps_the_limits_and_resists_turning_too(parts: Parts) -> None:
    touch = parts.touch
    touch.account[:] = 0.0
    touch.account[ARM] = 100.0
    touch.numbers[LIMIT], touch.numbers[WALL_LIMIT] = 1.5, 0.5
    touch.seen[:] = [[0.0, -2.0, 0.0], [4.0, 0.0, 0.0]]
    touch.felt[:] = 0.0
    brake(touch)
    np.testing.assert_allclose(touch.felt, [[0.0, 2.0, 0.0], [-2.0, 0.0, 0.0]])


def test_a_step_takes_up_what_the_arm_carries_and_moves_the_past() -> None:
    load = Effect("payload", {"mass_kg": 1.5, "since_s": 0.2})
    late = Effect("actuator_delay", {"delay_s": 0.002}, (1,))
    one = touched(pendulum(control=Control("pd", (20.0,), (-8.0,)), effects=(load, late)))
    parts = one.memory.parts
    past = parts.room.way.past
    past[:] = np.arange(past.size, dtype=float).reshape(past.shape)
    before, kept = parts.chain.inertial[-1, 9], past.copy()
    parts.clock[0] = 0.1
    begin_step(parts)
    assert (parts.chain.inertial[-1, 9], parts.counts[0]) == (before, 0)
    np.testing.assert_array_equal(past, np.concatenate([kept[1:], kept[-1:]]))
    parts.clock[0] = 0.2
    begin_step(parts)
    begin_step(parts)
    assert (parts.chain.inertial[-1, 9], parts.counts[0]) == (pytest.approx(before + 1.5), 1)
