"""How a link moves under a torque, against closed forms."""

import numpy as np
import pytest

from fitter.diagnosis.free_link import FreeLink, weightless

DT = 1e-3
T = np.arange(2001) * DT
ALL = slice(0, len(T))


def link(inertia: float, resistance: float, viscous: float = 0.0, coulomb: float = 0.0) -> FreeLink:
    return FreeLink(T, np.full(len(T), inertia), np.full(len(T), resistance), viscous, coulomb, 0.0)


def test_a_constant_torque_makes_a_parabola():
    angles, speeds = link(0.5, 0.2).moved(ALL, np.full(len(T), 0.7), 1.0, -0.3, DT)
    np.testing.assert_allclose(angles, 1.0 - 0.3 * T + 0.5 * T**2, atol=1e-12)
    np.testing.assert_allclose(speeds, -0.3 + T, atol=1e-12)


def test_viscous_friction_brakes_exponentially():
    _, speeds = link(0.5, 0.0, viscous=0.25).moved(ALL, np.zeros(len(T)), 0.0, 2.0, DT)
    np.testing.assert_allclose(speeds, 2.0 * np.exp(-0.5 * T), rtol=1e-3)


def test_dry_friction_brings_to_rest_and_holds():
    """From 1 rad/s at 2 rad/s^2 after half a second and a quarter of a radian; a torque below it moves nothing."""
    angles, speeds = link(0.5, 0.3, coulomb=0.7).moved(ALL, np.zeros(len(T)), 0.0, 1.0, DT)
    stop = round(0.5 / DT)
    np.testing.assert_array_equal(speeds[stop + 2 :], 0.0)
    assert angles[-1] == pytest.approx(0.25, abs=2 * DT)


def test_between_samples_it_is_as_beside_them():
    half = link(0.5, 0.2).at(T + 0.5 * DT)
    np.testing.assert_allclose(half.inertia, 0.5)
    np.testing.assert_allclose(half.resistance, 0.2)


def test_nothing_moves_a_link_of_which_no_inertia_is_known():
    angles, _ = weightless(T).moved(ALL, np.full(len(T), 5.0), 1.0, 0.1, DT)
    np.testing.assert_allclose(angles, 1.0 + 0.1 * T, atol=1e-12)
    assert weightless(T).lacking_acceleration(ALL) == np.inf
