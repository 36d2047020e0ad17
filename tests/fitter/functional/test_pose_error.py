"""How far poses may be off, against drawn noise."""

import numpy as np

from fitter.functional.pose_error import marker_variance, pose_covariance, turn_variance
from fitter.functional.rigid_fit import fit_poses
from tests.fitter.functional.test_rigid_fit import SHAPE

NOISE_M = 0.002
N = 40_000


def noisy():
    rng = np.random.default_rng(1)
    x = SHAPE + NOISE_M * rng.normal(size=(N, *SHAPE.shape))
    x[:, 4] = np.nan
    return fit_poses(SHAPE, x)


def test_the_noise_is_found_from_residuals():
    assert np.isclose(np.sqrt(marker_variance(noisy())), NOISE_M, rtol=0.01)


def test_the_covariance_of_a_point_is_that_of_draws():
    poses = noisy()
    at = np.array([0.3, -0.1, 0.2])
    said = pose_covariance(SHAPE, poses, at, NOISE_M**2)[0]
    assert np.allclose(said, np.cov(poses.to_world(at).T), atol=0.03 * np.trace(said))


def test_the_turn_is_that_of_draws():
    poses = noisy()
    angle = np.sqrt(np.mean(np.sum((poses.R - np.eye(3)) ** 2, axis=(1, 2)) / 2.0) / 3.0)
    assert np.isclose(np.sqrt(turn_variance(SHAPE, poses, NOISE_M**2)), angle, rtol=0.02)
