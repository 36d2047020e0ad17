"""Frequencies in units of their noise."""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from fitter.dynamics.noise_spectrum import noise_freedom, weighted_by_noise
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.spectral_sums import spectral_sums
from tests.fitter.regression_sums.test_spectral_sums import ARM, BASE, TRUE, wave


def fitted(trial):
    sums = weighted_by_noise(spectral_sums(ARM, BASE, [trial]), np.zeros(len(TRUE)), {})
    problem = torque_problem(sums, np.zeros(len(TRUE)))
    values = problem.complete(problem.optimum())
    return sums, values, problem.standard_errors(values)


def test_without_noise_the_answer_is_the_truth():
    sums, values, std = fitted(wave(0))
    assert np.allclose(values, TRUE, rtol=1e-6, atol=1e-8)
    assert np.all(std < 1e-4)


def test_errors_are_those_of_coloured_noise_in_a_short_trial():
    z = []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        trial = wave(seed, seconds=8.0)
        noise = lfilter([0.3], [1.0, -0.95], rng.normal(size=trial.tau.shape), axis=0)
        _, values, std = fitted(replace(trial, tau=trial.tau + noise))
        z.append((values - TRUE) / std)
    assert 0.85 < np.sqrt(np.mean(np.square(z))) < 1.2
    assert 0.9 < np.mean(np.abs(z) < 1.96) < 0.99


def test_a_noisy_band_counts_for_little():
    ratios = []
    for seed in range(8):
        trial = wave(seed, seconds=20.0)
        rng = np.random.default_rng(seed)
        hum = 2.0 * np.sin(2.0 * np.pi * 2.3 * trial.t + rng.uniform(0.0, 6.0))[:, None]
        loud = replace(trial, tau=trial.tau + hum + 0.02 * rng.normal(size=trial.tau.shape))
        _, values, _ = fitted(loud)
        quiet = torque_problem(spectral_sums(ARM, BASE, [loud]).sums, np.zeros(len(TRUE)))
        off = [np.abs(v - TRUE) for v in (values, quiet.complete(quiet.optimum()))]
        ratios.append(np.median(off[0] / off[1]))
    assert np.median(ratios) < 0.5


def test_what_is_held_stays():
    sums = weighted_by_noise(spectral_sums(ARM, BASE, [wave(0)]), np.zeros(len(TRUE)), {0: float(TRUE[0])})
    problem = torque_problem(sums, np.zeros(len(TRUE)), {0: float(TRUE[0])})
    assert np.allclose(problem.complete(problem.optimum()), TRUE, rtol=1e-6, atol=1e-8)


def test_a_noise_is_known_from_what_the_parameters_leave_of_the_joint_that_counts_least():
    trial, zero = wave(0, seconds=20.0), np.zeros(len(TRUE))
    seldom = np.zeros(trial.q.shape, dtype=bool)
    seldom[: -len(seldom) // 50, 0] = True
    for one in (trial, replace(trial, contradicted=seldom)):
        spectral = spectral_sums(ARM, BASE, [one])
        count = spectral.sums.count.sum(axis=0).min()
        freedom = noise_freedom(spectral, weighted_by_noise(spectral, zero, {}), zero, {})
        assert count - len(TRUE) <= freedom < count
