"""Geometry and noise from moments."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.data.trial import Trial
from fitter.kinematics.moment_fit import MomentProblem, enough
from fitter.kinematics.tip_basis import geometry_of

ARM = load_arm("dd-arm")
WHICH = np.array([1, 4, 5, 6, 8, 9])
TRUE = geometry_of(ARM)
BOUNDS = TRUE.ravel()[WHICH] - 0.3, TRUE.ravel()[WHICH] + 0.3


def poses(n, std, tip_std, seed, origin=(0.0, 0.0, 0.0)):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (n, 2))
    tip = tip_position(ARM, q) + origin + tip_std * rng.normal(size=(n, 3))
    return Trial("poses", np.arange(n) * 0.01, 0.01, q + std * rng.normal(size=q.shape), 0 * q, 0 * q, tip=tip)


def fit(trials, variance, estimated):
    start = TRUE * [1.0, 0.9, 1.0, 1.0, 1.0]
    return MomentProblem((True, True), trials).fit(start, WHICH, BOUNDS, variance, estimated, 0.02)


def test_both_are_found_and_the_errors_are_as_large_as_told():
    std = np.deg2rad([15.0, 8.0])
    found = fit([poses(12_000, std, 0.03, 0)], np.full(2, 0.01), np.ones(2, dtype=bool))
    errors = np.sqrt(np.diag(found.covariance))
    assert np.all(np.abs(found.geometry - TRUE).ravel()[WHICH] < 4.0 * errors)
    assert np.all(errors[[0, 3]] < 1e-3)
    assert np.all(np.abs(found.variance - std**2) < 4.0 * found.variance_std)
    assert np.allclose(np.sqrt(found.variance), std, rtol=0.2)
    assert found.tip_noise_m == pytest.approx(0.03, rel=0.05)


def test_each_trial_may_have_its_own_base():
    std = np.deg2rad([10.0, 10.0])
    trials = [poses(4000, std, 0.01, 1), poses(4000, std, 0.01, 2, (3.0, -1.0, 2.0))]
    found = fit(trials, std**2, np.zeros(2, dtype=bool))
    assert np.all(np.abs(found.geometry - TRUE).ravel()[WHICH] < 4.0 * np.sqrt(np.diag(found.covariance)))
    assert np.array_equal(found.variance, std**2)


def test_a_tip_that_is_measured_worse_in_one_direction():
    rng = np.random.default_rng(5)
    q = rng.uniform(-1.2, 1.2, (12_000, 2))
    tip = tip_position(ARM, q) + np.array([0.005, 0.04, 0.02]) * rng.normal(size=(12_000, 3))
    noisy = q + np.deg2rad(8.0) * rng.normal(size=q.shape)
    trial = Trial("depth", np.arange(12_000) * 0.01, 0.01, noisy, 0 * q, 0 * q, tip=tip)
    found = fit([trial], np.full(2, 0.01), np.ones(2, dtype=bool))
    assert np.allclose(np.rad2deg(np.sqrt(found.variance)), 8.0, atol=0.8)
    assert np.all(np.abs(found.geometry - TRUE).ravel()[WHICH] < 4.0 * np.sqrt(np.diag(found.covariance)))


def test_few_samples_or_many_joints_are_too_much_to_ask():
    assert enough((True, True), 10_000)
    assert not enough((True, True), 100)
    assert not enough((True,) * 6, 10_000_000)
    with pytest.raises(ValueError, match="100 samples of 2 joints"):
        MomentProblem((True, True), [poses(100, 0.1, 0.01, 0)])
