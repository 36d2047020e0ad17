"""Priors of a person's bodies: a scale's reading as one more observation."""

import numpy as np
import pytest

from fitter.ground.deformation import MASS, N_BODY
from fitter.ground.mass_prior import (
    CENTRE_RADII,
    MASS_SHARE,
    RADIUS_SHARE,
    TOTAL_SHARE,
    VAGUE,
    table_prior,
    vague_prior,
)

MASSES = np.array([40.0, 10.0, 3.0])


def test_without_a_scale_bodies_are_independent():
    prior = table_prior(MASSES, None)
    assert not prior.mean.any()
    std = [MASS_SHARE, *[CENTRE_RADII] * 3, *[RADIUS_SHARE] * 6]
    np.testing.assert_allclose(prior.covariance, np.diag(np.tile(std, 3) ** 2))


def test_a_scale_is_conditioned_on_as_normals_are():
    """The information of one more row adds up, and its pull is by least squares."""
    total = 60.0
    prior, plain = table_prior(MASSES, total), table_prior(MASSES, None)
    row = np.zeros(3 * N_BODY)
    row[[MASS, MASS + N_BODY, MASS + 2 * N_BODY]] = MASSES
    information = np.linalg.inv(plain.covariance) + np.outer(row, row) / (TOTAL_SHARE * total) ** 2
    np.testing.assert_allclose(prior.covariance, np.linalg.inv(information), rtol=1e-9, atol=1e-12)
    pulled = np.linalg.solve(information, row * (total - 53.0) / (TOTAL_SHARE * total) ** 2)
    np.testing.assert_allclose(prior.mean, pulled, atol=1e-12)
    assert row @ prior.mean == pytest.approx(7.0, rel=0.05) and prior.covariance[0, N_BODY] < 0.0


def test_a_vague_prior_is_ten_times_as_wide():
    prior = vague_prior(2)
    assert prior.mean.shape == (2 * N_BODY,) and not prior.mean.any()
    np.testing.assert_allclose(np.sqrt(prior.covariance[0, 0]), VAGUE * MASS_SHARE)
    assert np.count_nonzero(prior.covariance) == 2 * N_BODY
