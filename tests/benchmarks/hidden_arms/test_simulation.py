"""The hidden arm against closed forms, against Newton and Euler, and against the project's own simulation."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.special import ellipk

from arm.model import Arm, Control, Friction, Joint, Link
from arm.simulation import simulate as simulate_by_arm
from benchmarks.hidden_arms.arms import draw_arm, plain_arm
from benchmarks.hidden_arms.hidden_arm import (
    ACROSS,
    ALONG,
    DAMPING,
    DELAY_S,
    GAP,
    INERTIA,
    LAG_S,
    LENGTH,
    LIMIT,
    MASS,
    STIFFNESS,
    Floats,
    HiddenArm,
    Recorded,
)
from benchmarks.hidden_arms.simulation import simulate
from benchmarks.hidden_arms.unexplained import columns, fit, rms

RATE_HZ, TRIAL_S = 500.0, 4.0
LINKS = np.array([[0.3, 2.0, 0.14, 0.02, 0.03], [0.25, 1.2, 0.11, -0.03, 0.012], [0.2, 0.6, 0.09, 0.01, 0.004]])
GAINS = np.array([[40.0, -10.0], [14.0, -3.0], [4.0, -0.8]])
FRICTION = np.array([[0.05, 0.2, 0.0], [0.03, 0.08, 0.0], [0.01, 0.03, 0.0]])
DOWN = np.array([0.0, -9.80665])


def arm_of(n: int, **changes: object) -> HiddenArm:
    return plain_arm(LINKS[:n], np.zeros(2), GAINS[:n], FRICTION[:n])._replace(**changes)


def steps(n: int, seed: int = 0, count: int = 3) -> Floats:
    """Return targets that jump some times, held for 2 s each."""
    goals = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, n))
    return np.repeat(np.vstack([np.zeros(n), goals]), round(2.0 * RATE_HZ), axis=0)


def energy(arm: HiddenArm, q: Floats, dq: Floats) -> Floats:
    """Return kinetic and potential energy, with the plane's points as complex numbers."""
    turn, speed = np.cumsum(q, axis=1), np.cumsum(dq, axis=1)
    total, at, moving = np.zeros(len(q)), np.zeros(len(q), complex), np.zeros(len(q), complex)
    for i, link in enumerate(arm.links):
        way = np.exp(1j * turn[:, i])
        centre = (link[ALONG] + 1j * link[ACROSS]) * way
        v = moving + 1j * speed[:, i] * centre
        total += 0.5 * link[MASS] * np.abs(v) ** 2 + 0.5 * link[INERTIA] * speed[:, i] ** 2
        total -= link[MASS] * ((at + centre) * np.conj(arm.gravity[0] + 1j * arm.gravity[1])).real
        moving = moving + 1j * speed[:, i] * link[LENGTH] * way
        at = at + link[LENGTH] * way
    return total


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_free_arm_keeps_its_energy(n: int) -> None:
    arm = arm_of(n, gravity=DOWN, gains=np.zeros((n, 2)), friction=np.zeros((n, 3)))
    ref = np.zeros((1000, n))
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S, lead_s=0.0, q0=np.full(n, 0.4))
    total = energy(arm, motion.q, motion.dq)
    assert np.ptp(motion.dq[:, 0]) > 1.0
    assert np.ptp(total) < 1e-4 * np.ptp(energy(arm, motion.q, 0.0 * motion.dq))


@pytest.mark.parametrize("swing_rad", [0.1, 1.5, 2.8])
def test_a_pendulum_takes_its_time(swing_rad: float) -> None:
    arm = arm_of(1, gravity=np.array([9.80665, 0.0]), gains=np.zeros((1, 2)), friction=np.zeros((1, 3)))
    m, s = arm.links[0, MASS], np.hypot(arm.links[0, ALONG], arm.links[0, ACROSS])
    hanging = -np.arctan2(arm.links[0, ACROSS], arm.links[0, ALONG])
    slowest = np.sqrt((arm.links[0, INERTIA] + m * s * s) / (m * 9.80665 * s))
    period = 4.0 * slowest * ellipk(np.sin(swing_rad / 2.0) ** 2)
    n = round(3.2 * period * RATE_HZ)
    motion = simulate(
        arm, np.zeros((n, 1)), RATE_HZ, TRIAL_S, 8000.0, lead_s=0.0, q0=np.array([hanging + swing_rad])
    )
    angle = motion.q[:, 0] - hanging
    k = np.flatnonzero((angle[:-1] > 0.0) & (angle[1:] <= 0.0))
    down = (k + angle[k] / (angle[k] - angle[k + 1])) / RATE_HZ
    np.testing.assert_allclose(np.diff(down), period, rtol=2e-5)


@pytest.mark.parametrize("gravity", [np.zeros(2), DOWN])
@pytest.mark.parametrize("n", [1, 2, 3])
def test_it_moves_as_the_project_simulates_it(n: int, gravity: Floats) -> None:
    arm, ref = arm_of(n, gravity=gravity), steps(n)
    hidden = simulate(arm, ref, RATE_HZ, TRIAL_S, 8000.0, lead_s=0.0)
    known = known_arm(arm)
    dense = simulate_by_arm(known, np.repeat(ref, 8, axis=0), 1.0 / (8 * RATE_HZ), ref[0])
    assert np.abs(hidden.q - dense.q[::8]).max() < 2e-4
    np.testing.assert_allclose(hidden.u, dense.tau[::8], atol=2e-3 * np.abs(hidden.u).max())


def known_arm(arm: HiddenArm) -> Arm:
    """Return the same arm in the project's terms: inertia about the joint, friction, the law."""
    joints = []
    for link, (viscous, coulomb, static) in zip(arm.links.tolist(), arm.friction.tolist(), strict=True):
        length, m, along, across, inertia = link
        turning = inertia + m * (along**2 + across**2)
        body = Link(m, (along, across, 0.0), (turning, turning, turning, 0.0, 0.0, 0.0))
        joints.append(Joint(a_m=length, friction=Friction(viscous, coulomb, static), link=body))
    law = Control("pd", tuple(arm.gains[:, 0].tolist()), tuple(arm.gains[:, 1].tolist()))
    return replace(Arm("known", tuple(joints), (*arm.gravity.tolist(), 0.0)), control=law)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), vertical=st.booleans())
@example(seed=466265, vertical=False)  # a joint that never moves
def test_base_columns_explain_a_plain_arm(seed: int, vertical: bool) -> None:
    rng = np.random.default_rng(seed)
    arm = draw_arm(rng, vertical, [])
    n = len(arm.links)
    arm = arm._replace(friction=rng.uniform(0.0, 0.02, (n, 3)) * np.array([1.0, 1.0, 0.0]))
    motion = simulate(arm, steps(n, seed), RATE_HZ, TRIAL_S, 2000.0, lead_s=0.0)
    Y = columns(arm.links[:, LENGTH], arm.gravity, motion.link_q, motion.link_dq, motion.link_ddq)
    used = slides(motion, 2000.0)
    residual = rms(motion.u - Y @ fit(Y, motion.u, used), used)
    assert np.all(residual <= 1e-4 * rms(motion.u, used))  # friction is found to about so much


def slides(motion: Recorded, step_hz: float) -> NDArray[np.bool_]:
    """Say which joints move, and don't stop within the step."""
    within: NDArray[np.bool_] = np.abs(motion.link_dq) > 1.01 * np.abs(motion.link_ddq) / step_hz
    return within


def test_a_joint_stops_where_friction_holds_it() -> None:
    arm = arm_of(1, gains=np.array([[5.0, -1.0]]), friction=np.array([[0.0, 0.5, 0.0]]))
    ref = np.concatenate([np.zeros((100, 1)), np.ones((2000, 1))])
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S, lead_s=0.0)
    at_rest = motion.q[-1, 0]
    assert motion.dq[-1, 0] == 0.0
    assert motion.q[-500, 0] == at_rest
    assert 0.0 < abs(1.0 - at_rest) <= 0.5 / 5.0


@pytest.mark.parametrize(("pull", "moves"), [(0.29, False), (0.31, True)])
def test_static_friction_holds_up_to_its_limit(pull: float, moves: bool) -> None:
    arm = arm_of(2, gains=np.array([[1.0, -0.5], [1.0, -0.5]]), friction=np.array([[0.0, 0.1, 0.3]] * 2))
    ref = np.concatenate([np.zeros((10, 2)), np.full((500, 2), [pull, 0.0])])
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S, lead_s=0.0)
    assert bool(np.any(motion.q[:, 0] != 0.0)) is moves


def test_friction_never_drives() -> None:
    arm, ref = arm_of(3, friction=10.0 * FRICTION), steps(3)
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S, lead_s=0.0)
    Y = columns(arm.links[:, LENGTH], arm.gravity, motion.link_q, motion.link_dq, motion.link_ddq)
    m, along, across = arm.links[:, MASS], arm.links[:, ALONG], arm.links[:, ACROSS]
    about_joint = arm.links[:, INERTIA] + m * (along**2 + across**2)
    rigid = Y[:, :, :12] @ np.stack([m, m * along, m * across, about_joint], axis=1).ravel()
    friction = motion.drive - rigid
    resting = motion.link_dq == 0.0
    assert resting.mean() > 0.1
    assert (np.abs(friction) <= 10.0 * FRICTION[:, 1] + 1e-6)[resting].all()
    assert (friction * np.sign(motion.link_dq) >= 9.99 * FRICTION[:, 1])[slides(motion, 4000.0)].all()


def test_the_torque_comes_late() -> None:
    arm, ref = arm_of(2), steps(2)
    arm.drive[0, DELAY_S] = 0.012
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S)
    np.testing.assert_array_equal(motion.drive[6:, 0], motion.u[:-6, 0])
    np.testing.assert_array_equal(motion.drive[:, 1], motion.u[:, 1])


def test_the_torque_follows_slowly() -> None:
    arm, ref, lag_s = arm_of(2), steps(2), 0.03
    arm.drive[0, LAG_S] = lag_s
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S)
    after = slice(1100, 1900)
    change = np.gradient(motion.drive[:, 0], 1.0 / RATE_HZ)
    np.testing.assert_allclose((motion.u[:, 0] - motion.drive[:, 0])[after], lag_s * change[after], atol=2e-2)


def test_the_motor_gives_no_more() -> None:
    arm, ref = arm_of(2), steps(2)
    arm.drive[1, LIMIT] = 3.0
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S)
    assert np.abs(motion.u[:, 1]).max() > 5.0
    np.testing.assert_array_equal(motion.drive[:, 1], np.clip(motion.u[:, 1], -3.0, 3.0))


def test_a_transmission_twists_by_what_it_carries() -> None:
    arm, ref, k, d = arm_of(2), steps(2), 150.0, 2.0
    arm.transmission[0, [STIFFNESS, DAMPING]] = k, d
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S)
    lead, yielding = motion.q - motion.link_q, motion.dq - motion.link_dq
    assert np.abs(lead[:, 0]).max() > 0.01
    np.testing.assert_allclose(k * lead[:, 0] + d * yielding[:, 0], motion.drive[:, 0], atol=1e-9)
    kp, kv = arm.gains[0]
    np.testing.assert_allclose(kp * (ref - motion.q)[:, 0] + kv * motion.dq[:, 0], motion.u[:, 0], atol=1e-9)


def test_play_leads_where_the_motor_pushes() -> None:
    arm, ref, gap = arm_of(2), steps(2), 0.02
    arm.transmission[0, GAP] = gap
    motion = simulate(arm, ref, RATE_HZ, TRIAL_S)
    lead, pushed = (motion.q - motion.link_q)[:, 0], motion.drive[:, 0]
    assert (np.abs(lead) <= 0.5 * gap + 1e-12).all()
    assert (pushed > 0.1).any() and (pushed < -0.1).any()
    np.testing.assert_allclose(lead[np.abs(pushed) > 0.0], 0.5 * gap * np.sign(pushed[np.abs(pushed) > 0.0]))
