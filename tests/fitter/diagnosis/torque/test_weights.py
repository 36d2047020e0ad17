"""Weighted rows are white, and lose what is not known and nothing else."""

import numpy as np

from fitter.diagnosis.torque.weights import Unknown, Weights, log_variances


def _covariance(n=60):
    f = np.linspace(0.1, 6.0, n)
    return np.diag([1.0, 0.2]) + np.array([[1.0, 0.5], [0.5, 0.3]]) * (f**2)[:, None, None]


def _none(n=60):
    nothing = np.zeros((n, 2, 0), dtype=np.complex128)
    return Unknown(nothing, nothing)


def _noise(covariance, k, seed=0):
    white = np.random.default_rng(seed).normal(size=(len(covariance), 2, k, 2)) @ np.array([1.0, 1j])
    return np.linalg.cholesky(covariance) @ white


def test_noise_becomes_white_and_goes_back():
    covariance = _covariance()
    weights, noise = Weights(covariance, _none()), _noise(covariance, 200)
    rows = weights.rows(noise)
    np.testing.assert_allclose(np.mean(rows**2), 1.0, rtol=0.05)
    np.testing.assert_allclose(weights.torque(rows), noise, rtol=1e-9)
    assert weights.n_effective == rows.shape[0]
    np.testing.assert_allclose(weights.log_variance, log_variances(covariance))


def test_a_torque_of_any_size_leaves_no_trace_and_takes_its_rows():
    covariance = _covariance()
    shapes = _noise(covariance, 5, seed=1)
    weights = Weights(covariance, Unknown(shapes, _none().roughly))
    assert np.abs(weights.rows(1e6 * shapes)).max() < 1e-4
    rows = weights.rows(_noise(covariance, 400, seed=2))
    np.testing.assert_allclose(np.mean(np.sum(rows**2, axis=0)), weights.n_effective, rtol=0.02)
    np.testing.assert_allclose(weights.n_effective, rows.shape[0] - 5, rtol=1e-6)


def test_a_torque_of_known_size_has_variance_one_with_the_noise():
    covariance = _covariance()
    shapes = 3.0 * _noise(covariance, 4, seed=3)
    weights = Weights(covariance, Unknown(_none().anyhow, shapes))
    sizes = np.random.default_rng(4).normal(size=(4, 2000))
    rows = weights.rows(_noise(covariance, 2000, seed=5) + shapes @ sizes)
    np.testing.assert_allclose(np.mean(np.sum(rows**2, axis=0)), rows.shape[0], rtol=0.02)
