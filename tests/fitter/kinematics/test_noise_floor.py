"""Noise that shows in spectra."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.data.trial import Trial
from fitter.kinematics.noise_floor import NEGLIGIBLE, noise_floor

ARM = load_arm("dd-arm")


def measured(q, std, tip_std=0.0, seed=0):
    rng = np.random.default_rng(seed)
    tip = tip_position(ARM, q) + tip_std * rng.normal(size=(len(q), 3))
    noisy = q + std * rng.normal(size=q.shape)
    return Trial("m", np.arange(len(q)) * 0.01, 0.01, noisy, 0 * q, 0 * q, tip=tip)


def point_to_point(n=6000, leg=200, seed=0):
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, 1.0, leg, endpoint=False)
    corners = rng.uniform(-1.5, 1.5, (n // leg + 1, 2))
    step = 10 * u**3 - 15 * u**4 + 6 * u**5
    return np.concatenate([a + (b - a) * step[:, None] for a, b in zip(corners[:-1], corners[1:], strict=True)])


@pytest.mark.parametrize("tip_std", [0.0, 0.03])
@pytest.mark.parametrize("deg", [(15.0, 15.0), (1.0, 5.0), (0.0, 10.0)])
def test_white_noise_on_a_smooth_motion(deg, tip_std):
    std = np.deg2rad(deg)
    trials = [measured(point_to_point(seed=seed), std, tip_std, seed) for seed in range(2)]
    found = noise_floor((True, True), trials)
    assert np.allclose(found, std, rtol=0.05, atol=NEGLIGIBLE)


def test_the_bench_has_none(bench_trials):
    assert np.all(noise_floor((True, True), bench_trials) < NEGLIGIBLE)


@pytest.mark.parametrize("std", [0.0, 0.05, 0.26])
def test_samples_that_were_taken_one_by_one_have_no_floor(std):
    rng = np.random.default_rng(0)
    q = rng.uniform(-1.2, 1.2, (8000, 2))
    assert noise_floor((True, True), [measured(q, std, 0.01)]) is None
    drifting = 0.2 * q + np.cumsum(rng.normal(size=q.shape), axis=0) * 0.01  # and around somewhere else each time
    assert noise_floor((True, True), [measured(drifting, std / 5, 0.001)]) is None


def test_neighbours_that_resemble_each_other_are_not_yet_smooth():
    rng = np.random.default_rng(1)
    q = np.zeros((8000, 2))
    for k in range(1, len(q)):
        q[k] = 0.5 * q[k - 1] + 0.5 * rng.normal(size=2)
    assert noise_floor((True, True), [measured(q, 0.05, 0.01)]) is None


@pytest.mark.parametrize("n", [64, 300, 1000])
def test_nor_have_few_of_them(n):
    q = np.random.default_rng(n).uniform(-1.2, 1.2, (n, 2))
    assert noise_floor((True, True), [measured(q, 0.0)]) is None


def test_a_short_trial_tells_nothing():
    trial = measured(point_to_point()[:40], 0.1)
    assert noise_floor((True, True), [trial]) is None
    assert noise_floor((True, True), [replace(trial, q=trial.q[:10])]) is None
