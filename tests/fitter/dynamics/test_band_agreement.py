"""Whether frequencies agree about an arm."""

from dataclasses import replace

import numpy as np

from fitter.dynamics.band_agreement import frequencies_agree
from fitter.dynamics.noise_spectrum import weighted_by_noise
from fitter.regression_sums.spectral_sums import spectral_sums
from tests.fitter.regression_sums.test_spectral_sums import ARM, BASE, TRUE, wave


def agree(trial):
    spectral, prior = spectral_sums(ARM, BASE, [trial]), np.zeros(len(TRUE))
    return frequencies_agree(spectral, weighted_by_noise(spectral, prior, {}), prior, {})


def noisy(seed, **noise):
    """Return a trial with white noise of the sizes given in columns of it."""
    rng, trial = np.random.default_rng(seed), wave(seed, seconds=20.0)
    columns = {name: getattr(trial, name) + size * rng.normal(size=trial.q.shape) for name, size in noise.items()}
    return replace(trial, **columns)


def test_noise_of_the_torque_is_no_disagreement():
    # each is a false alarm with a probability of 0.001
    assert sum(agree(noisy(seed, tau=0.05)) for seed in range(20)) >= 19


def test_noise_of_the_regressors_in_a_clean_torque_is():
    assert not any(agree(noisy(seed, ddq=20.0, tau=1e-4)) for seed in range(5))


def test_one_sought_parameter_is_compared_alone():
    trial = noisy(3, tau=0.05)
    spectral, prior = spectral_sums(ARM, BASE, [trial]), np.zeros(len(TRUE))
    held = {k: float(TRUE[k]) for k in range(1, len(TRUE))}
    assert frequencies_agree(spectral, weighted_by_noise(spectral, prior, held), prior, held)
