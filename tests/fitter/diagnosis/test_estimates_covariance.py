"""Covariances of factors and psi against plain least squares and differences."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.drive_hypotheses import Lag
from fitter.diagnosis.estimates import _between, covariance_of, information_of, slopes
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from tests.fitter.diagnosis.searched import swinging

LAG = Lag(catalogue()["actuator_lag"], (0,))


@pytest.fixture(scope="module")
def regression():
    return swinging(Effect("actuator_lag", {"time_constant_s": 0.02}, joints=(1,)), trials=6)


@pytest.fixture(scope="module")
def final(regression):
    return fitted(regression, Model().plus(LAG, np.array([0.02])))


def test_slopes_are_the_design_and_what_a_change_of_psi_makes(regression, final):
    motion, step = regression.motions[0], 1e-5
    found = slopes(regression, final, motion)
    np.testing.assert_array_equal(found[:, :-1], regression.rows(final.model, motion).design)
    moved = final.model.at(final.model.flat + step)
    change = regression.residual(final.model, final.x, motion) - regression.residual(moved, final.x, motion)
    np.testing.assert_allclose(found[:, -1], change.ravel() / step, atol=1e-2 * np.abs(found[:, -1]).max())


def test_information_is_the_slopes_products(regression, final):
    whole = np.vstack([slopes(regression, final, one) for one in regression.learning])
    np.testing.assert_allclose(information_of(regression, final), whole.T @ whole, rtol=1e-9)


def test_numbers_are_known_no_better_than_white_noise_says(regression, final):
    plain = np.sqrt(np.diag(np.linalg.inv(information_of(regression, final))))
    found = covariance_of(regression, final, regression.learning)
    np.testing.assert_allclose(found, found.T, rtol=1e-9)
    assert np.linalg.eigvalsh(found).min() > 0.0
    ratio = np.sqrt(np.diag(found)) / plain
    assert np.all(ratio > 0.99) and np.median(ratio) < 2.0


def test_the_scatter_of_whole_trials_is_that_of_white_noise_where_they_differ_by_no_more():
    rng = np.random.default_rng(0)
    A, trial = rng.normal(size=(20_000, 3)), np.repeat(np.arange(200), 100)
    nothing = np.zeros((200, 3)), np.zeros((3, 3))
    noise = rng.normal(size=len(A))
    np.testing.assert_allclose(_between(A, noise, trial, *nothing), 1.0, atol=4.0 * np.sqrt(2.0 / 200))
    own = np.sum(A * rng.normal(size=(200, 3))[trial], axis=1) + noise  # each trial with numbers of its own
    np.testing.assert_allclose(_between(A, own, trial, *nothing), 101.0, rtol=4.0 * np.sqrt(2.0 / 200))
    # Groups that have nothing to do with trials see the fourth moments: 1 + E a^2 (a c)^2 = 1 + 3 + 2.
    others = _between(A, own, rng.permutation(trial), *nothing)
    np.testing.assert_allclose(others, 6.0, atol=4.0 * 6.0 * np.sqrt(2.0 / 200))
