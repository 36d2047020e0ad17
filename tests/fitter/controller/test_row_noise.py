"""Noise of rows from draws: the same by single rows and by their sum."""

import numpy as np
import pytest

from fitter.controller.row_noise import RowNoise


def test_weighted_variances_add_up_to_the_gram():
    rng = np.random.default_rng(0)
    noise, x = RowNoise(rng.normal(size=(5, 30, 2, 4))), rng.normal(size=4)
    weights = rng.uniform(0.5, 2.0, 60)
    assert x @ noise.gram(weights) @ x == pytest.approx(weights @ noise.variance(x), rel=1e-12)


def test_the_variance_is_that_of_the_draws():
    rng = np.random.default_rng(1)
    noise = RowNoise(rng.normal(size=(500, 20, 1, 2)) * [3.0, 1.0])
    np.testing.assert_allclose(noise.variance(np.array([1.0, 0.0])), 9.0, rtol=0.15)
    np.testing.assert_allclose(noise.variance(np.array([1.0, 2.0])), 13.0, rtol=0.15)
