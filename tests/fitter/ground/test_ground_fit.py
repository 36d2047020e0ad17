"""Bodies from equations that are nearly linear: Gauss's answer, and errors as often as they say."""

import numpy as np
import pytest

from fitter.ground.deformation import Deformation
from fitter.ground.frequency_rows import FrequencyRows
from fitter.ground.ground_fit import ground_fit
from fitter.ground.mass_prior import MassPrior

#: A block of 3 kg with its centre off the origin.
LINK = np.array([[0.0275, 0.06, 0.0775, -0.015, 0.0, 0.0, 0.3, 0.15, 0.0, 3.0]])
BODY = Deformation(LINK)
N = 200


def prior(std):
    return MassPrior(np.zeros(10), np.eye(10) * std**2)


def equations(seed, x, noise, disturbance=0.0, n=N):
    """Return rows of random slopes; the last column is a disturbance."""
    rng = np.random.default_rng(seed)
    Y = rng.normal(size=(n, 6, 11))
    w = Y[..., :10] @ BODY.parameters(x) + disturbance * Y[..., 10] + noise * rng.normal(size=(n, 6))
    return FrequencyRows(Y, w, np.arange(n) / 8.0, np.zeros(n, dtype=np.intp))


def test_what_is_told_exactly_is_found_exactly():
    x = 0.1 * np.random.default_rng(0).normal(size=10)
    found = ground_fit(equations(1, x, 0.0), BODY, prior(0.3), np.zeros(1))
    np.testing.assert_allclose(found.x, x, atol=1e-4)
    assert found.power.max() < 1e-6 and found.rounds > 1


def test_the_power_is_that_of_the_noise():
    found = ground_fit(equations(2, np.zeros(10), 0.05), BODY, prior(0.3), np.zeros(1))
    assert found.power.shape[1] == 6
    assert np.mean(found.power) == pytest.approx(0.05**2, rel=0.1)


@pytest.mark.parametrize("std", [0.01, 0.001])
def test_near_the_prior_the_covariance_is_gausss(std):
    rows = equations(3, np.zeros(10), 0.05)
    found = ground_fit(rows, BODY, prior(std), np.zeros(1))
    A = (rows.Y[..., :10] @ BODY.slopes(found.x)).reshape(-1, 10)
    expected = np.linalg.inv(A.T @ A / 0.05**2 + np.eye(10) / std**2)
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), np.sqrt(np.diag(expected)), rtol=0.1)


def test_a_disturbance_widens_the_errors_and_they_hold():
    z, plain = [], ground_fit(equations(4, np.zeros(10), 0.02), BODY, prior(0.3), np.zeros(1))
    rng = np.random.default_rng(5)
    for seed in range(20):
        x = 0.1 * rng.normal(size=10)
        found = ground_fit(equations(10 + seed, x, 0.02, 0.2 * rng.normal()), BODY, prior(0.3), np.array([0.2]))
        z.append((found.x - x) / np.sqrt(np.diag(found.covariance)))
    assert np.trace(found.covariance) > 4.0 * np.trace(plain.covariance)
    assert 0.9 < np.mean(np.abs(z) < 1.96) <= 1.0


def test_nothing_measured_leaves_the_prior():
    rows = equations(6, np.zeros(10), 1.0)
    rows = FrequencyRows(np.zeros_like(rows.Y), rows.w, rows.hz, rows.trial)
    found = ground_fit(rows, BODY, MassPrior(np.full(10, 0.1), np.eye(10) * 0.04), np.zeros(1))
    np.testing.assert_allclose(found.x, 0.1, atol=1e-9)
    np.testing.assert_allclose(found.covariance, np.eye(10) * 0.04, atol=1e-9)


def test_what_moves_like_a_body_bounds_what_is_known_of_it():
    """A disturbance of the first number's own slopes: the error is its standard deviation, however many rows."""
    rows = equations(7, np.zeros(10), 0.01)
    Y = rows.Y.copy()
    Y[..., 10] = Y[..., :10] @ BODY.slopes(np.zeros(10))[:, 0]
    found = ground_fit(FrequencyRows(Y, rows.w, rows.hz, rows.trial), BODY, prior(0.3), np.array([0.05]))
    assert np.sqrt(found.covariance[0, 0]) == pytest.approx(0.05, rel=0.1)
    assert np.sqrt(found.covariance[1, 1]) < 0.01
