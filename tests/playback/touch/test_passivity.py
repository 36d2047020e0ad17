"""Touching never gives energy: what a hand can get out of wall and arm, sample by sample, without any clock."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.model import Arm, Friction
from arm.newton_euler import mass_matrix
from playback.touch.grip import Hand
from playback.touch.limit import UNBOUND, Bound, Coupling, stiffness_limit, wall_limit
from playback.touch.touched_arm import TouchedArm

T = 1e-3
B = 5.0


class Reckless(Coupling):
    """A coupling that is given as it is asked for."""

    def within(self, interval_s: float, mass: Bound = UNBOUND, inertia: Bound = UNBOUND) -> Coupling:
        return self


def smooth_arm(**changes) -> Arm:
    """Return the paper's arm without friction, which is negative in places there, free to move."""
    arm = load_arm("dd-arm")
    joints = tuple(replace(joint, friction=Friction()) for joint in arm.joints)
    return replace(arm, joints=joints, control=replace(arm.control, law="measured"), **changes)


@dataclass
class SampledHand:
    """A mass with a damper between two ticks, the force on it held; solved exactly."""

    mass: float
    damping: float
    x: np.ndarray
    v: np.ndarray

    def move(self, force: np.ndarray) -> float:
        """Move for one tick and return what its damper took [J]."""
        before = self.v @ self.v
        if self.damping == 0.0:
            step = self.v * T + force * T * T / (2.0 * self.mass)
            self.v = self.v + force * T / self.mass
        else:
            tau = self.mass / self.damping
            end, gone = force / self.damping, -np.expm1(-T / tau)
            step = end * T + (self.v - end) * tau * gone
            self.v = self.v + (end - self.v) * gone
        self.x = self.x + step
        return float(force @ step) - 0.5 * self.mass * float(self.v @ self.v - before)


def touch(arm: TouchedArm, hand: SampledHand, pushes: np.ndarray, settle: int = 0) -> np.ndarray:
    """Push a hand about; return what has come out of the arm beyond what the hand's damper took, by tick."""
    arm.take(arm.tip, Hand(hand.x))
    for _ in range(settle):  # the ramp, during which stiffness is put in
        arm.step(1, Hand(hand.x))
    out, total = [], -arm.energy()["stored"]
    for push in pushes:
        felt, at = arm.felt[0].copy(), hand.x.copy()
        taken = hand.move(felt + push)
        total += float(felt @ (hand.x - at)) - taken
        out.append(total)
        arm.step(1, Hand(hand.x, hand.v))
    return np.array(out)


def wall_arm() -> TouchedArm:
    """Return an arm with a wall as stiff as is passive, and no coupling to the arm itself."""
    return TouchedArm(smooth_arm(), np.array([0.3, 0.6]), T, Coupling(0.0, 0.0, B, 1e4, wall=(0.0, 1.0, 0.0, 0.0)))


def reckless_wall(share: float) -> TouchedArm:
    """Return an arm with a wall of a multiple of the limit."""
    wall = (0.0, 1.0, 0.0, 0.0)
    asked = Reckless(0.0, 0.0, B, 1e4, wall=wall, wall_stiffness=share * wall_limit(B, T))
    return TouchedArm(smooth_arm(), np.array([0.3, 0.6]), T, asked)


def push_hold_leave() -> np.ndarray:
    """Return the force on a hand that is pushed against the wall, held there, and taken away."""
    force = np.zeros((3000, 3))
    force[:400, 1], force[400:2000, 1], force[2000:, 1] = -8.0, -30.0, 12.0
    return force


def at_wall(damping: float, mass: float = 0.2) -> SampledHand:
    return SampledHand(mass, damping, np.array([0.4, 0.004, 0.0]), np.zeros(3))


def test_a_wall_of_the_limit_stiffness_is_touched_held_and_left_without_energy_from_it() -> None:
    arm, hand = wall_arm(), at_wall(B)
    arm.step(1)
    out = touch(arm, hand, push_hold_leave(), settle=250)
    assert arm.given.wall_stiffness == pytest.approx(wall_limit(B, T)) == pytest.approx(1e4)
    assert out.max() <= 1e-12
    assert out.min() < -1e-3  # it was really touched
    assert hand.x[1] > 0.0  # and left
    assert arm.energy()["passive"]
    assert arm.energy()["braked_ticks"] == 0


def test_without_damping_the_same_wall_gives_energy() -> None:
    arm, hand = wall_arm(), at_wall(0.0)
    out = touch(arm, hand, push_hold_leave(), settle=250)
    assert out.max() > 1.0
    assert np.abs(hand.v[1]) > 1.0


@settings(max_examples=15, deadline=None)
@given(st.floats(0.02, 2.0), st.integers(0, 2**32 - 1))
def test_no_hand_gets_energy_from_the_wall(mass: float, seed: int) -> None:
    pushes = np.repeat(np.random.default_rng(seed).normal(scale=20.0, size=(40, 3)), 25, axis=0)
    pushes[:, 1] -= 10.0
    arm, hand = wall_arm(), at_wall(B, mass)
    assert touch(arm, hand, pushes, settle=250).max() <= 1e-12


@pytest.mark.parametrize(("share", "grows"), [(1.0, False), (1.01, True)])
def test_the_limit_of_the_wall_is_the_limit(share: float, grows: bool) -> None:
    """The worst motion there is: to and fro at constant speed, turning back at every tick, inside the wall."""
    arm = reckless_wall(share)
    x, deep = np.array([0.4, -0.01, 0.0]), np.array([0.4, -0.011, 0.0])
    arm.take(arm.tip, Hand(x))
    for _ in range(250):
        arm.step(1, Hand(x))
    out = 0.0
    for k in range(1000):
        to = deep if k % 2 == 0 else x
        step = to - (x if k % 2 == 0 else deep)
        out += float(arm.felt[0] @ step) - B * float(step @ step) / T
        arm.step(1, Hand(to, np.zeros(3)))  # it says that it rests, so that nothing brakes it
    assert (out > 1e-6) is grows


def pulled_arm(asked: Coupling) -> TouchedArm:
    return TouchedArm(smooth_arm(gravity_m_s2=(0.0, 0.0, 0.0)), np.array([0.3, 0.6]), T, asked)


def pulls(seed: int, n: int = 60) -> np.ndarray:
    return np.repeat(np.random.default_rng(seed).normal(scale=5.0, size=(n, 3)), 40, axis=0) * [1.0, 1.0, 0.2]


@settings(max_examples=10, deadline=None)
@given(st.floats(0.05, 1.0), st.floats(0.05, 0.9), st.integers(0, 2**32 - 1))
def test_no_hand_gets_energy_from_the_arm_at_the_limit(mass: float, share: float, seed: int) -> None:
    damping = share * B
    asked = Coupling(stiffness_limit(B, damping, T) * (1.0 - 1e-9), damping, B, 1e4)
    arm = pulled_arm(asked)
    hand = SampledHand(mass, B, arm.touched_point(arm.tip), np.zeros(3))
    out = touch(arm, hand, pulls(seed), settle=250)
    assert (arm.given.stiffness, arm.given.damping) == (asked.stiffness, asked.damping)
    assert out.max() <= 1e-9
    assert arm.energy()["passive"]
    assert arm.energy()["braked_ticks"] == 0


def test_without_damping_the_same_coupling_gives_energy() -> None:
    arm = pulled_arm(Reckless(stiffness_limit(B, B / 4.0, T), 0.0, B, 1e4))
    hand = SampledHand(0.05, 0.0, arm.touched_point(arm.tip), np.zeros(3))
    out = touch(arm, hand, np.concatenate([pulls(1, 10), np.zeros((4000, 3))]), settle=250)
    assert out.max() > 0.1


def test_the_passivity_controller_notices_a_wall_that_is_too_stiff() -> None:
    arm, hand = reckless_wall(1.5), at_wall(B)
    out = touch(arm, hand, push_hold_leave(), settle=250)
    assert arm.energy()["braked_ticks"] > 0
    assert out.max() < 1e-3


def test_the_work_on_the_arm_is_its_energy() -> None:
    arm = pulled_arm(Coupling(800.0, 1.0, B, 1e4))
    hand = SampledHand(0.3, B, arm.touched_point(arm.tip), np.zeros(3))
    touch(arm, hand, pulls(4), settle=10)
    dq = arm.state[1]
    kinetic = 0.5 * float(dq @ mass_matrix(arm.arm, arm.state[0])[0] @ dq)
    account = arm.energy()
    assert kinetic > 1e-3
    assert account["arm"] == pytest.approx(kinetic, rel=1e-6)
    assert account["dissipated"] + account["device"] >= 0.0
