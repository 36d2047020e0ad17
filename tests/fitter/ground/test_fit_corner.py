"""The corner is where the misfit's power comes near the force's."""

import numpy as np
import pytest

from benchmarks.simulated_people.ground import BASE, PERSON, moving, other_masses, trial_of
from fitter.data.derivatives import lowpass
from fitter.ground.fit_corner import FASTEST_HZ, fit_corner_hz

N = 2000


@pytest.fixture(scope="module")
def trial():
    rng = np.random.default_rng(0)
    theta = other_masses(BASE, rng)
    q = moving(PERSON, rng, 20.0)
    return trial_of(PERSON, BASE, q, q, theta, np.zeros((len(q), 6))), theta


def corner(trial, theta, noise):
    made = type(trial)(**{**trial.__dict__, "wrench": trial.Y @ theta + noise})
    return fit_corner_hz([made], theta)


def test_without_misfit_everything_is_fitted(trial):
    one, theta = trial
    assert corner(one, theta, 0.0) == FASTEST_HZ


def test_where_misfit_drowns_the_force_nothing_is(trial):
    one, theta = trial
    noise = np.random.default_rng(1).normal(size=one.wrench.shape)
    assert corner(one, theta, 1e4 * noise) == 1.0


def test_the_corner_is_where_a_broad_force_ends(trial):
    """Force of one power up to 3 Hz, misfit of a hundredth of it everywhere."""
    one, theta = trial
    rng = np.random.default_rng(2)
    n = len(one.wrench)
    force = lowpass(rng.normal(size=(n, 6)), one.dt_s, 3.0)
    misfit = 0.1 * rng.normal(size=(n, 6))
    made = type(one)(**{**one.__dict__, "wrench": force, "Y": (force - misfit)[:, :, None]})
    assert 2.5 < fit_corner_hz([made], np.ones(1)) < 5.0
