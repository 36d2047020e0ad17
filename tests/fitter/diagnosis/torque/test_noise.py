"""Floors and sensors' noise are found again from coefficients that have them."""

import numpy as np
import pytest

from fitter.diagnosis.torque.noise import floor_of, sensor_noise, with_floor

F = np.linspace(0.2, 15.0, 400)
MIXED = np.array([[1.0, 0.6], [0.6, 0.5]])


def _draw(covariance, seed, times=1):
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(covariance)
    white = rng.normal(size=(times, *covariance.shape[:2], 2)) @ np.array([1.0, 1j])
    return (root @ white[..., None])[..., 0]


def _sensors(f):
    return np.diag([1e-4, 4e-5]) + 1e-8 * MIXED * ((2.0 * np.pi * f) ** 4)[:, None, None]


@pytest.mark.parametrize(
    "floor", [[[0.02, 0.0], [0.0, 0.0]], [[0.0, 0.005], [3.0, 0.0]], [[0.01, 0.01], [0.0, 2.0]]]
)
def test_a_floor_is_found_where_it_is(floor):
    own, floor = _sensors(F), np.array(floor)
    found = np.mean(
        [
            floor_of(_draw(with_floor(own, floor), k)[0], own, np.ones((400, 2)), np.ones((2, 2)))
            for k in range(20)
        ],
        0,
    )
    np.testing.assert_allclose(found[0], floor[0], rtol=0.15, atol=5e-4)  # of sensors' 1e-4 and more
    np.testing.assert_allclose(found[1], floor[1], rtol=0.15, atol=0.1)  # a tenth of the sensors' own


def test_noise_alone_has_next_to_no_floor():
    own = _sensors(F)
    found = floor_of(_draw(own, 3)[0], own, np.ones((400, 2)), np.ones((2, 2)))
    assert np.all(found[0] < np.array([1e-4, 4e-5]))
    assert np.all(found[1] < 0.2)


def test_sensor_noise_is_that_of_the_draw_in_any_unit():
    draws = _draw(_sensors(F), 5, times=6)
    f = np.tile(F, 6)
    for unit in (1.0, 1e-6):
        found = sensor_noise(f, unit * draws.reshape(-1, 2)).covariance(F[20::50])
        ratio = np.linalg.eigvals(np.linalg.solve(unit**2 * _sensors(F[20::50]), found)).real
        assert np.all((ratio > 0.5) & (ratio < 2.0))
        np.testing.assert_allclose(ratio.mean(), 1.0, atol=0.15)
