"""Torques at a joint: their definitions, where they let go of a resting joint, and energy."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from arm.effects.joint_torque import torque_along
from arm.effects.resisting_torque import resisting_torque
from arm.model import Effect
from arm.simulation import simulate

DT, INERTIA = 1e-3, 0.5
#: What the joint resists with, from its state and the effect's parameters in their order.
DEFINITIONS = {
    "viscous": lambda t, q, dq, way, tau, D, fc, c: c * dq,
    "coulomb": lambda t, q, dq, way, tau, D, fc, c: c * way,
    "coulomb_asymmetry": lambda t, q, dq, way, tau, D, fc, c: c * abs(way),
    "stribeck": lambda t, q, dq, way, tau, D, fc, A, v: A * np.exp(-((dq / v) ** 2)) * way,
    "load_friction": lambda t, q, dq, way, tau, D, fc, c: c * abs(tau) * way,
    "quadratic_drag": lambda t, q, dq, way, tau, D, fc, c: c * dq * abs(dq),
    "joint_spring": lambda t, q, dq, way, tau, D, fc, k, q0: k * (q - q0),
    "end_stop": lambda t, q, dq, way, tau, D, fc, at, k, side: (
        k * (np.maximum(q - at, 0.0) if side > 0 else np.minimum(q - at, 0.0))
    ),
    "passive_tissue": lambda t, q, dq, way, tau, D, fc, at, M, rate, c, side: (
        M * np.exp(rate * side * (q - at)) * (side + c * dq)
    ),
    "cogging": lambda t, q, dq, way, tau, D, fc, A, phase, N: -A * np.sin(N * q + phase),
    "torque_offset": lambda t, q, dq, way, tau, D, fc, c: -c,
    "thermal_drift": lambda t, q, dq, way, tau, D, fc, rate: rate * t * (D * dq + fc * way),
    "periodic_disturbance": lambda t, q, dq, way, tau, D, fc, A, f, phase: -A * np.sin(2 * np.pi * f * t + phase),
    "external_push": lambda t, q, dq, way, tau, D, fc, start, lasts, c: -c * (start <= t <= start + lasts),
}


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
@pytest.mark.parametrize("name", DEFINITIONS)
def test_it_is_as_defined(name, seed):
    rng = np.random.default_rng(seed)
    state = np.array([rng.uniform(0, 3), *rng.normal(size=2), 0.0, *rng.normal(size=3)])
    state[3] = np.sign(state[2])
    numbers = rng.uniform(0.1, 2.0, len(catalogue()[name].numbers))
    if name in ("end_stop", "passive_tissue"):  # the side is the last
        numbers[-1] = rng.choice([-1.0, 1.0])
    (torque,) = torque_along(catalogue()[name], numbers, state[None])
    np.testing.assert_allclose(torque, DEFINITIONS[name](*state, *numbers), rtol=1e-13, atol=1e-14)


def let_go(arm, rate=1.0, seconds=3.0):
    """Return at which torque a resting wheel begins to move when it is pulled harder and harder."""
    torque = rate * np.arange(round(seconds / DT))[:, None] * DT
    motion = simulate(arm, torque, DT, np.zeros(1), torque=torque)
    return float(torque[np.flatnonzero(motion.dq[:, 0])[0], 0]) - rate * DT


@pytest.mark.parametrize(
    ("name", "numbers", "forwards", "backwards"),
    [
        ("coulomb", {"coulomb_N_m": 0.5}, 0.9, -0.9),
        ("coulomb_asymmetry", {"difference_N_m": 0.3}, 0.7, -0.1),
        ("stribeck", {"amplitude_N_m": 0.7, "velocity_rad_s": 0.1}, 1.1, -1.1),
        ("stiction", {"static_N_m": 1.3}, 1.3, -1.3),
        ("load_friction", {"coefficient": 0.2}, 0.5, -0.5),
        ("torque_offset", {"torque_N_m": 0.3}, 0.1, -0.7),
        ("joint_spring", {"stiffness_N_m_rad": 2.0, "rest_angle_rad": -0.1}, 0.6, -0.2),
        ("cogging", {"amplitude_N_m": 0.2, "phase_rad": np.pi / 2, "periods_per_turn": 6.0}, 0.2, -0.6),
        ("gain_error", {"factor": 0.5}, 0.8, -0.8),
    ],
)
def test_where_a_resting_joint_lets_go(wheel, having, rubbing, name, numbers, forwards, backwards):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), name, **numbers)
    assert let_go(arm) == pytest.approx(forwards, abs=1.1 * DT)
    assert let_go(arm, rate=-1.0) == pytest.approx(backwards, abs=1.1 * DT)


def test_static_friction_is_all_that_holds_where_it_is_more_than_sliding_friction(wheel, having, rubbing):
    arm = having(rubbing(wheel, 0.1, 0.4, 1.3), "stribeck", amplitude_N_m=0.5, velocity_rad_s=0.1)
    assert let_go(arm) == pytest.approx(1.3, abs=1.1 * DT)
    more = having(arm, "stribeck", amplitude_N_m=0.6, velocity_rad_s=0.1)
    assert let_go(more) == pytest.approx(1.5, abs=1.1 * DT)


def test_a_joint_that_effects_alone_hold_sticks_and_stays(wheel, having):
    """It has no friction of its own; where it comes to rest it moves no more, to the last bit."""
    arm = having(wheel, "load_friction", coefficient=0.1)
    arm = having(arm, "stribeck", amplitude_N_m=0.5, velocity_rad_s=0.3)
    motion = simulate(arm, np.full((6000, 1), 0.3), DT, np.zeros(1))
    moving = np.flatnonzero(motion.dq[:, 0])
    assert 100 < len(moving) < 5500
    np.testing.assert_array_equal(np.unique(motion.q[moving[-1] + 1 :]), motion.q[-1])
    assert abs(motion.tau[-1, 0]) * 0.9 <= 0.5


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


def test_springs_stops_and_ripples_give_back_what_they_took(wheel, having):
    arm = having(wheel, "joint_spring", stiffness_N_m_rad=3.0, rest_angle_rad=0.2)
    arm = having(arm, "end_stop", angle_rad=0.9, stiffness_N_m_rad=200.0, side=1)
    arm = having(arm, "cogging", amplitude_N_m=0.4, phase_rad=0.7, periods_per_turn=8.0)
    none = np.zeros((20_000, 1))
    motion = simulate(arm, none, 2e-4, np.array([-1.2]), torque=none)
    q, dq = motion.q[:, 0], motion.dq[:, 0]
    energy = INERTIA / 2 * dq**2 + 1.5 * (q - 0.2) ** 2 + 100.0 * np.maximum(q - 0.9, 0.0) ** 2
    energy += 0.4 / 8.0 * np.cos(8.0 * q + 0.7)
    assert q.max() > 0.95
    np.testing.assert_allclose(energy, energy[0], rtol=3e-6)


#: A knee's ends (Anderson 1999, table G.2): angle [rad], moment [N m] there, rate [1/rad]; flexion is negative.
EXTENDED, FLEXED = (0.13, 6.09, 33.94), (-2.40, 11.03, 11.33)


def knee_of(wheel, having, damping_s=0.0):
    for side, (angle, moment, rate) in ((1.0, EXTENDED), (-1.0, FLEXED)):
        stated = {"angle_rad": angle, "moment_N_m": moment, "rate_1_rad": rate}
        wheel = having(wheel, "passive_tissue", **stated, damping_s=damping_s, side=side)
    return wheel


def test_two_ends_of_a_range_are_a_knees_published_passive_moment(wheel, having):
    knee = knee_of(wheel, having)
    q = np.linspace(-2.5, 0.2, 28)[:, None]
    seen = resisting_torque(knee, q, 0 * q, 0 * q, 0 * q, np.zeros(len(q)))
    published = -6.09 * np.exp(33.94 * (q - 0.13)) + 11.03 * np.exp(-11.33 * (q + 2.40))
    np.testing.assert_allclose(seen, -published, rtol=1e-12)
    assert np.abs(seen[(q > -1.8) & (q < 0.0)]).max() < 0.1  # it is felt near the ends alone


@pytest.mark.parametrize("damping_s", [0.0, 0.1])
def test_tissue_keeps_a_knee_in_its_range_and_gives_back_no_more_than_it_took(wheel, having, damping_s):
    knee = knee_of(wheel, having, damping_s)
    none = np.zeros((20_000, 1))
    motion = simulate(knee, none, 2e-4, np.array([-1.0]), np.array([4.0]), torque=none)
    q, dq = motion.q[:, 0], motion.dq[:, 0]
    energy = INERTIA / 2 * dq**2 + 6.09 / 33.94 * np.exp(33.94 * (q - 0.13))
    energy += 11.03 / 11.33 * np.exp(-11.33 * (q + 2.4))
    assert -2.7 < q.min() < -2.2 and 0.1 < q.max() < 0.3
    if damping_s:
        assert np.all(np.diff(energy) < 1e-6) and energy[-1] < 0.8 * energy[0]
    else:
        np.testing.assert_allclose(energy, energy[0], rtol=1e-5)


@pytest.mark.parametrize(
    "name", ["viscous", "coulomb", "stribeck", "quadratic_drag", "load_friction", "thermal_drift"]
)
def test_friction_only_takes(wheel, having, rubbing, name):
    """A spring's energy never grows while nothing drives the joint."""
    arm = having(rubbing(wheel, 0.05, 0.1, 0.0), "joint_spring", stiffness_N_m_rad=20.0, rest_angle_rad=0.0)
    numbers = {p.name: min(0.3, p.high) for p in catalogue()[name].parameters}
    arm = having(arm, name, **numbers)
    none = np.zeros((3000, 1))
    motion = simulate(arm, none, DT, np.array([1.0]), torque=none)
    energy = INERTIA / 2 * motion.dq[:, 0] ** 2 + 10.0 * motion.q[:, 0] ** 2
    assert np.all(np.diff(energy) < 1e-9) and energy[-1] < 0.9 * energy[0]


def test_the_runs_time_goes_on_from_trial_to_trial(wheel, having):
    arm = having(wheel, "periodic_disturbance", amplitude_N_m=0.3, frequency_hz=1.3, phase_rad=0.4)
    arm = having(arm, "external_push", start_s=2.5, duration_s=0.1, torque_N_m=-1.0)
    ref = np.full((2001, 1), 0.3)
    whole = simulate(arm, np.tile(ref, (2, 1))[:4001], DT, np.zeros(1))
    second = simulate(arm, ref, DT, whole.q[2000], whole.dq[2000], t0_s=2.0)
    np.testing.assert_allclose(second.q, whole.q[2000:], rtol=0, atol=1e-9)
    assert not np.allclose(second.q, simulate(arm, ref, DT, whole.q[2000], whole.dq[2000]).q, atol=1e-3)


def test_friction_that_has_warmed(wheel, having, rubbing):
    arm = having(rubbing(wheel, 0.2, 0.4, 0.0), "thermal_drift", rate_1_s=0.01)
    ref = np.full((1500, 1), 0.8)
    warm = simulate(arm, ref, DT, np.zeros(1), t0_s=50.0)
    assert warm.dq.max() > 0.5
    same = simulate(replace(rubbing(wheel, 0.3, 0.6, 0.0)), ref, DT, np.zeros(1))
    np.testing.assert_allclose(warm.q, same.q, rtol=0, atol=4e-3)  # it goes on warming by 1 % in that time
    before = simulate(arm, ref, DT, np.zeros(1), t0_s=-50.0)
    cold = simulate(rubbing(wheel, 0.2, 0.4, 0.0), ref, DT, np.zeros(1))
    np.testing.assert_array_equal(before.q, cold.q)


def test_effects_may_be_on_several_joints_and_several_times(arm):
    twice = replace(arm, effects=(Effect("viscous", {"viscous_N_m_s": 0.2}, (1, 3)),) * 2)
    friction = [
        replace(j.friction, viscous_N_m_s=j.friction.viscous_N_m_s + 0.4 * (i != 1))
        for i, j in enumerate(arm.joints)
    ]
    same = replace(arm, joints=tuple(replace(j, friction=f) for j, f in zip(arm.joints, friction, strict=True)))
    ref = np.tile([0.6, -0.3, 0.5], (500, 1))
    runs = [simulate(each, ref, DT, np.full(3, 0.2)).q for each in (twice, same)]
    np.testing.assert_allclose(runs[0], runs[1], rtol=0, atol=1e-11)
