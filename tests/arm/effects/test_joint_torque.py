"""C functions of effects, called by their address along a motion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from arm.effects.joint_torque import torque_along, torque_at, torques_along
from arm.simulation import simulate

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


def test_every_effect_at_a_joint_is_defined_here():
    assert set(DEFINITIONS) == {kind.name for kind in catalogue().values() if kind.torque is not None}


def test_several_sets_of_numbers_are_several_columns():
    kind, rng = catalogue()["cogging"], np.random.default_rng(0)
    states, numbers = rng.normal(size=(5, 7)), rng.uniform(0.1, 2.0, (3, 3))
    found = torques_along(kind, numbers, states[::-1][::-1])
    expected = -numbers[:, 0] * np.sin(np.outer(states[:, 1], numbers[:, 2]) + numbers[:, 1])
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)
    address, padded = kind.torque.address, np.array([*numbers[2], 0.0, 0.0])
    assert torque_at(address, states[4], padded) == found[4, 2]


@pytest.mark.parametrize(
    "name", ["viscous", "coulomb", "stribeck", "quadratic_drag", "load_friction", "thermal_drift"]
)
def test_friction_only_takes(wheel, having, rubbing, name):
    """A spring's energy never grows while nothing drives the joint."""
    arm = having(rubbing(wheel, 0.05, 0.1, 0.0), "joint_spring", stiffness_N_m_rad=20.0, rest_angle_rad=0.0)
    numbers = {p.name: min(0.3, p.high) for p in catalogue()[name].numbers}
    arm = having(arm, name, **numbers)
    none = np.zeros((3000, 1))
    motion = simulate(arm, none, 1e-3, np.array([1.0]), torque=none)
    energy = 0.5 / 2 * motion.dq[:, 0] ** 2 + 10.0 * motion.q[:, 0] ** 2
    assert np.all(np.diff(energy) < 1e-9) and energy[-1] < 0.9 * energy[0]


def test_conservative_effects_together_give_back_what_they_took(wheel, having):
    arm = having(wheel, "joint_spring", stiffness_N_m_rad=3.0, rest_angle_rad=0.2)
    arm = having(arm, "end_stop", angle_rad=0.9, stiffness_N_m_rad=200.0, side=1)
    arm = having(arm, "cogging", amplitude_N_m=0.4, phase_rad=0.7, periods_per_turn=8.0)
    none = np.zeros((20_000, 1))
    motion = simulate(arm, none, 2e-4, np.array([-1.2]), torque=none)
    q, dq = motion.q[:, 0], motion.dq[:, 0]
    energy = 0.5 / 2 * dq**2 + 1.5 * (q - 0.2) ** 2 + 100.0 * np.maximum(q - 0.9, 0.0) ** 2
    energy += 0.4 / 8.0 * np.cos(8.0 * q + 0.7)
    assert q.max() > 0.95
    np.testing.assert_allclose(energy, energy[0], rtol=3e-6)
