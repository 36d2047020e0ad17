"""A model that makes both sides of its equation smaller is no likelier for that."""

import numpy as np
import pytest

from fitter.diagnosis.torque.density import Density, log_density, mass_covariance
from tests.fitter.diagnosis.torque.runs import likelihood


@pytest.mark.parametrize("phi", [0.0, 0.3, 1.0])
def test_a_smaller_slope_takes_back_what_a_smaller_residual_gains(phi):
    sensors, masses = np.zeros((50, 2)), np.zeros(2)
    smaller = Density(sensors - 2.0, masses - 2.0)
    share, freedom = np.full((50, 2), phi), np.full((50, 2), 0.8)
    fell = log_density(smaller, Density(sensors, masses), share, freedom)
    np.testing.assert_allclose(fell, -2.0 * 0.8 * 100)


def test_masses_are_found_by_a_draw():
    white = np.random.default_rng(0).normal(size=(4000, 2, 2)) @ np.array([1.0, 1j])
    M = np.array([[2.0, 0.4], [0.4, 0.3]])
    np.testing.assert_allclose(mass_covariance(white @ M.T), M @ M.T, rtol=0.1)


def test_a_shaken_motion_has_other_accelerations_where_no_torque_was_measured():
    run = likelihood()
    one = run.motions[0]
    other = run.shaken[one.number]
    assert np.std(other.ddq - one.ddq) == pytest.approx(1.0, rel=0.2)
    np.testing.assert_array_equal(other.u, one.u)
