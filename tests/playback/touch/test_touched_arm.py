"""The arm that is touched: forces against cases by hand, motion against the simulation of `arm`."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import axis_frames
from arm.model import Arm, Control, Effect, Friction, Joint, Link
from arm.newton_euler import mass_matrix
from arm.outer_wrench import touched_forward_dynamics
from arm.simulation import simulate
from limbcal.errors import DataError
from playback.touch.grip import Grip, Hand
from playback.touch.limit import Coupling
from playback.touch.touched_arm import RAMP_S, TouchedArm
from tests.arm.conftest import draw_arm

T = 1e-3
Q0 = np.array([0.4, -0.9])


def frictionless(arm: Arm, **changes) -> Arm:
    return replace(arm, joints=tuple(replace(joint, friction=Friction()) for joint in arm.joints), **changes)


def jacobian(q: np.ndarray, a: float = 0.25, b: float = 0.3) -> np.ndarray:
    """Return that of the tip of two links in a plane, by hand."""
    s1, c1, s12, c12 = np.sin(q[0]), np.cos(q[0]), np.sin(q[0] + q[1]), np.cos(q[0] + q[1])
    return np.array([[-a * s1 - b * s12, -b * s12], [a * c1 + b * c12, b * c12], [0.0, 0.0]])


def test_pushed_at_the_tip_an_arm_comes_to_rest_where_its_control_balances_the_hand() -> None:
    control = Control("pd", (400.0, 300.0), (-60.0, -40.0))
    arm = TouchedArm(
        frictionless(load_arm("dd-arm"), control=control), Q0, T, Coupling(300.0, 1.0, max_force=100.0)
    )
    x = arm.touched_point(arm.tip) + [0.02, -0.03, 0.0]
    arm.take(arm.tip, Hand(x))
    for _ in range(8000):
        arm.step(1, Hand(x))
    q, force = arm.state[0], arm.felt[0]
    assert np.abs(arm.state[1]).max() < 1e-11
    np.testing.assert_allclose(force, -300.0 * (x - arm.touched_point(arm.tip)), rtol=0, atol=1e-9)
    held = np.array(control.kp) * (Q0 - q)
    np.testing.assert_allclose(jacobian(q).T @ -force + held, 0.0, rtol=0, atol=1e-9)
    assert np.linalg.norm(force) > 3.0


@pytest.mark.parametrize("joint", [1, 4, 7])
def test_a_chain_of_seven_starts_as_the_equations_say(joint: int) -> None:
    rng = np.random.default_rng(joint)
    drawn = frictionless(draw_arm(rng, 7), control=Control())
    q, point = rng.uniform(-1.0, 1.0, 7), rng.uniform(-0.2, 0.2, 3)
    arm = TouchedArm(drawn, q, 1e-6, Coupling(50.0, 0.0, 1e3, max_force=1e3))
    grip = Grip(joint, tuple(point.tolist()))
    x = arm.touched_point(grip) + [0.1, 0.2, -0.1]
    arm.take(grip, Hand(x))
    arm.step(1, Hand(x))
    force = np.array([0.1, 0.2, -0.1]) * 50.0 * (1e-6 / RAMP_S)  # the coupling has only begun to grow
    expected = touched_forward_dynamics(drawn, q[None], 0 * q[None], 0 * q[None], joint, point, force)[0]
    np.testing.assert_allclose(arm.state[2], expected, rtol=0, atol=1e-3 * np.abs(expected).max())
    np.testing.assert_allclose(arm.felt[0], -force, rtol=1e-3)
    np.testing.assert_allclose(arm.felt[1], 0.0, atol=0)


def test_a_hand_that_turns_feels_a_moment_and_turns_the_arm() -> None:
    control = Control("pd", (40.0, 30.0), (-20.0, -10.0))
    arm = TouchedArm(
        frictionless(load_arm("dd-arm"), control=control),
        Q0,
        T,
        Coupling(0.0, 0.0, turn_device=0.1, max_moment=5.0),
    )
    x = arm.touched_point(arm.tip)

    def turned(angle: float) -> np.ndarray:
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    arm.take(arm.tip, Hand(x, None, turned(0.5)))  # however it was when it took hold
    for k in range(12_000):
        arm.step(1, Hand(x, None, turned(0.5 + 0.4 * min(k / 1000.0, 1.0))))
    twist = 0.4 - float(np.sum(arm.state[0] - Q0))
    moment = arm.felt[1]
    np.testing.assert_allclose(moment, [0.0, 0.0, -2.0 * twist], rtol=0, atol=1e-6)
    np.testing.assert_allclose(np.array(control.kp) * (Q0 - arm.state[0]), moment[2], rtol=0, atol=1e-6)
    assert arm.energy()["passive"]


EFFECTS = {
    "none": (),
    "spring": (Effect("joint_spring", {"stiffness_N_m_rad": 8.0, "rest_angle_rad": 0.4}, (2,)),),
    "late": (
        Effect("actuator_delay", {"delay_s": 0.0123}, (1, 2)),
        Effect("actuator_lag", {"time_constant_s": 0.02}, (2,)),
    ),
    "twist": (Effect("joint_elasticity", {"stiffness_N_m_rad": 300.0, "damping_N_m_s": 1.0}, (1,)),),
    "load": (Effect("payload", {"mass_kg": 2.0, "since_s": 0.2}),),
    "pushed": (Effect("external_push", {"start_s": 0.1003, "duration_s": 0.2, "torque_N_m": 3.0}, (2,)),),
}


@pytest.mark.parametrize("name", EFFECTS)
def test_untouched_it_moves_as_the_simulation_does(name: str) -> None:
    model = frictionless(load_arm("dd-arm-vertical"), effects=EFFECTS[name])
    ref = np.tile([0.5, -0.3], (401, 1))
    ref[0] = Q0
    expected = simulate(model, ref, T, Q0)
    arm = TouchedArm(model, Q0, T, Coupling())
    links = expected.link_q if hasattr(expected, "link_q") else expected.q
    for k in range(400):
        np.testing.assert_allclose(arm.state[0], links[k], rtol=0, atol=1e-9)
        arm.step(1)
        arm.hold(ref[1])


def test_friction_is_that_of_the_simulation_but_for_the_last_of_a_step() -> None:
    joints = tuple(replace(j, friction=Friction(0.05, 0.4, 0.6)) for j in load_arm("dd-arm").joints)
    model = replace(load_arm("dd-arm"), joints=joints)
    ref = np.tile([0.5, -0.3], (6001, 1))
    ref[0] = Q0
    expected = simulate(model, ref, T, Q0)
    arm, q = TouchedArm(model, Q0, T, Coupling()), []
    for _ in range(6001):
        q.append(arm.state[0].copy())
        arm.step(1)
        arm.hold(ref[1])
    assert np.abs(np.array(q) - expected.q).max() < 1e-4
    assert expected.dq[-1, 0] == arm.state[1, 0] == 0.0  # it sticks, short of its target
    assert abs(arm.state[0, 0] - ref[1, 0]) > 1e-3


def test_several_steps_at_once_are_as_good_as_one_by_one() -> None:
    one, many = (TouchedArm(load_arm("dd-arm"), Q0, T, Coupling()) for _ in range(2))
    x = one.touched_point(one.tip)
    for arm in (one, many):
        arm.take(arm.tip, Hand(x))
        arm.free()
    for k in range(100):
        to = x + [0.0, 2e-3 * (k + 1), 0.0]
        many.step(5, Hand(to))
        for part in range(1, 6):
            one.step(1, Hand(to - [0.0, 2e-3 * (1.0 - part / 5.0), 0.0]))
    np.testing.assert_allclose(many.state[:2], one.state[:2], rtol=0, atol=0.03)
    assert np.abs(one.state[1]).max() > 0.05


def test_the_force_grows_from_nothing_is_limited_and_ends_when_let_go() -> None:
    arm = TouchedArm(load_arm("dd-arm"), Q0, T, Coupling(1000.0, 1.0, max_force=7.0))
    x = arm.touched_point(arm.tip) + [
        0.0,
        0.0,
        0.3,
    ]  # away from the plane in which the arm moves: it cannot follow
    arm.take(arm.tip, Hand(x))
    strength = []
    for _ in range(400):
        arm.step(1, Hand(x))
        strength.append(np.linalg.norm(arm.felt[0]))
    assert strength[0] < 7.0 * 0.3
    assert np.diff(strength).min() > -1e-9
    assert max(strength) == pytest.approx(7.0)
    assert strength[2] < 6.0
    arm.let_go()
    arm.step(1)
    assert not arm.felt.any()
    assert arm.energy()["stored"] == 0.0


def test_an_arm_whose_torque_was_measured_is_free_until_it_is_held() -> None:
    model = frictionless(load_arm("dd-arm-vertical"), control=Control())
    arm = TouchedArm(model, Q0, T, Coupling())
    for _ in range(200):
        arm.step(1)
    assert np.abs(arm.state[0] - Q0).max() > 0.05  # it falls
    arm.reset(Q0)
    arm.hold()
    for _ in range(500):
        arm.step(1)
    np.testing.assert_allclose(arm.state[0], Q0, rtol=0, atol=1e-9)
    arm.hold([0.0, 0.2])
    for _ in range(3000):
        arm.step(1)
    np.testing.assert_allclose(arm.state[0], [0.0, 0.2], rtol=0, atol=1e-3)
    arm.free()
    before = mass_matrix(arm.arm, arm.state[0])
    arm.step(100)
    assert np.abs(arm.state[0] - [0.0, 0.2]).max() > 1e-3
    assert before.shape == (1, 2, 2)


def test_what_does_not_fit_is_refused() -> None:
    arm = TouchedArm(load_arm("dd-arm"), Q0, T, Coupling())
    for q in ([0.0], [0.0, np.nan], [[0.0, 0.0]]):
        with pytest.raises(DataError, match="expected 2 finite numbers"):
            arm.reset(q)
    for joint in (0, 3):
        with pytest.raises(DataError, match=f"joint is {joint}, expected one of 1 to 2"):
            arm.take(Grip(joint, (0.0, 0.0, 0.0)), Hand(np.zeros(3)))
    assert arm.tip == Grip(2, (0.3, 0.0, 0.0))


def test_a_place_on_one_link_is_not_that_on_another() -> None:
    drawn, point = draw_arm(np.random.default_rng(3), 3), (0.1, -0.05, 0.2)
    q = np.array([0.3, -0.7, 1.1])
    arm = TouchedArm(frictionless(drawn, control=Control()), q, T, Coupling())
    for held in (1, 2, 3):
        arm.take(Grip(held, point), Hand(arm.touched_point(Grip(held, point))))
        arm.step(1, Hand(arm.touched_point(Grip(held, point))))
        for joint in (1, 2, 3):
            pose = axis_frames(drawn, arm.state[:1])[0, joint - 1]
            expected = pose[:3, :3] @ np.array(point) + pose[:3, 3]
            np.testing.assert_allclose(arm.touched_point(Grip(joint, point)), expected, rtol=0, atol=1e-6)


def test_a_hand_that_does_not_say_how_fast_it_is_goes_from_place_to_place() -> None:
    """What it feels, and what is damped, goes by how fast it is."""
    felt, energy = [], []
    for says in (True, False):
        arm = TouchedArm(frictionless(load_arm("dd-arm"), control=Control()), Q0, T, Coupling())
        x, v = arm.touched_point(arm.tip), np.array([0.2, -0.1, 0.0])
        arm.take(arm.tip, Hand(x, v if says else None))
        for k in range(1, 60):
            arm.step(3, Hand(x + 3 * k * T * v, v if says else None))
        felt.append(arm.felt.copy())
        energy.append(arm.energy()["dissipated"])
    np.testing.assert_allclose(felt[0], felt[1], rtol=1e-6, atol=1e-9)
    assert energy[0] == pytest.approx(energy[1], rel=1e-6)


@pytest.mark.parametrize(("trials", "carried"), [([1], True), ([2], False)])
def test_it_carries_what_the_first_trial_does(trials: list[int], carried: bool) -> None:
    bare = frictionless(load_arm("dd-arm-vertical"), control=Control())
    payload = replace(bare, effects=(Effect("payload", {"mass_kg": 2.0, "trials": trials}),))
    start = []
    for model in (bare, payload):
        arm = TouchedArm(model, Q0, T, Coupling())
        arm.step(1)
        start.append(arm.state[2].copy())
    assert (np.abs(start[0] - start[1]).max() > 0.1) == carried


def test_a_coupling_that_grows_while_nothing_moves_dissipates_nothing() -> None:
    """Across its plane the arm does not yield; what is stored then was put in by the stiffness as it grew."""
    arm = TouchedArm(load_arm("dd-arm"), Q0, T, Coupling(300.0, 1.0))
    x = arm.touched_point(arm.tip) + [0.0, 0.0, 0.01]
    arm.take(arm.tip, Hand(x))
    for _ in range(300):
        arm.step(1, Hand(x))
    energy = arm.energy()
    stored = 0.5 * 300.0 * 0.01**2
    assert (energy["stored"], energy["injected"]) == (pytest.approx(stored), pytest.approx(stored))
    assert (energy["hand"], energy["arm"], energy["dissipated"]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(("stiffness", "felt"), [(None, 5.0), (0.0, 0.0)])
def test_coupling_and_wall_share_the_largest_force(stiffness: float | None, felt: float) -> None:
    arm = TouchedArm(load_arm("dd-arm"), Q0, T, Coupling(400.0, 1.0, max_force=10.0))
    x = arm.touched_point(arm.tip) + [0.0, 0.0, 0.3]
    wall = (0.0, 0.0, -1.0, 0.2 - float(x[2]))  # the hand is 0.2 m inside
    walled = Coupling(400.0, 1.0, max_force=10.0, wall=wall, wall_stiffness=stiffness)
    arm = TouchedArm(load_arm("dd-arm"), Q0, T, walled)
    arm.take(arm.tip, Hand(x))
    for _ in range(300):
        arm.step(1, Hand(x))
    assert arm.felt[0] == pytest.approx([0.0, 0.0, -5.0 - felt], abs=1e-6)  # both pull it back


def test_a_light_arm_is_held_as_stiffly_as_its_step_follows() -> None:
    model, step_s = load_arm("dd-arm"), 5e-3
    arm = TouchedArm(model, Q0, step_s, Coupling(1e6, 1.0, 1e6, turn_stiffness=1e6, turn_device=1e6))
    x = arm.touched_point(arm.tip)
    arm.take(arm.tip, Hand(x, None, np.eye(3)))
    arm.step(1, Hand(x, None, np.eye(3)))
    inverse = np.linalg.inv(mass_matrix(model, Q0)[0])
    lightest = np.linalg.eigvalsh(jacobian(Q0) @ inverse @ jacobian(Q0).T)[-1]
    turning = np.ones(2) @ inverse @ np.ones(2)  # both joints turn the tip about the same axis
    assert arm.given.stiffness == pytest.approx(1.0 / lightest / step_s**2)
    assert arm.given.turn_stiffness == pytest.approx(1.0 / turning / step_s**2)


def test_a_rotor_is_felt_as_inertia_of_the_arm() -> None:
    """Of a link without mass it is all that there is: at the tip it weighs its inertia over the length squared."""
    rotor = Effect("rotor_inertia", {"inertia_kg_m2": 0.02}, (1,))
    arm = TouchedArm(Arm("geared", (Joint(a_m=0.5),), effects=(rotor,)), np.zeros(1), T, Coupling(1e6, 1.0, 1e4))
    x = arm.touched_point(arm.tip)
    arm.take(arm.tip, Hand(x))
    arm.step(1, Hand(x))
    assert arm.given.stiffness == pytest.approx(0.02 / 0.5**2 / T**2)
    arm.reset(np.zeros(1))
    arm.hold(np.ones(1))  # critically damped at 2 Hz
    arm.step(100)
    left = (1.0 + 4.0 * np.pi * 0.1) * np.exp(-4.0 * np.pi * 0.1)
    assert arm.state[0] == pytest.approx([1.0 - left], abs=1e-6)


@pytest.mark.parametrize("mass_kg", [1e-4, 1e-3, 1e-2])
def test_a_light_arm_takes_a_strong_damper(mass_kg: float) -> None:
    """Two rods of 5 cm, whose tip the hand leads round: a spring is stretched by 1 cm, and no blow is felt."""
    rod = Link(mass_kg, (0.025, 0.0, 0.0), (0.0, *(2 * [mass_kg * 0.05**2 / 3.0]), 0.0, 0.0, 0.0))
    arm = TouchedArm(Arm("light", 2 * (Joint(a_m=0.05, link=rod),)), Q0, T, Coupling(400.0, 20.0, 50.0, 1e3))
    x = arm.touched_point(arm.tip)
    arm.take(arm.tip, Hand(x))
    for k in range(600):
        arm.step(1, Hand(x + 0.01 * np.array([np.sin(0.01 * k), np.sin(0.013 * k), 0.0])))
        assert np.linalg.norm(arm.felt) < 10.0
    assert arm.energy()["passive"]


@pytest.mark.parametrize(("ticks", "share"), [(50, 0.25), (100, 0.5), (200, 1.0), (300, 1.0)])
def test_the_coupling_grows_over_a_fifth_of_a_second(ticks: int, share: float) -> None:
    arm = TouchedArm(load_arm("dd-arm"), Q0, T, Coupling(300.0, 1.0))
    x = arm.touched_point(arm.tip) + [0.0, 0.0, 0.01]  # across its plane the arm does not yield
    arm.take(arm.tip, Hand(x))
    for _ in range(ticks):
        arm.step(1, Hand(x))
    assert arm.felt[0] == pytest.approx([0.0, 0.0, -300.0 * 0.01 * share], abs=1e-6)
    assert arm.energy()["passive"] is True and arm.energy()["braked_ticks"] == 0
