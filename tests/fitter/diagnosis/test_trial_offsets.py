"""Constant torques that trials lack: their scatter comes back, and what all trials share or few have is none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.error_floor import floored, regression_of
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.trial_offsets import _scatter, offset_sizes
from tests.fitter.diagnosis.two_joints import regression_of_two

TRIALS, WHITE = 16, 0.05


@pytest.fixture(scope="module")
def plain():
    return regression_of_two(trials=2 * TRIALS)


def missing(plain, offsets):
    """Return equations whose drives miss white torques, and constant ones (n_trial, n_joint)."""
    rng = np.random.default_rng(3)
    both = zip(plain.motions, [*offsets, *offsets], strict=True)
    motions = [replace(one, u=one.u + off + WHITE * rng.normal(size=one.u.shape)) for one, off in both]
    return regression_of(plain.arm, motions)


def found_in(plain, offsets):
    """Return the offsets under weights of the white torques alone."""
    white = missing(plain, np.zeros((TRIALS, 2)))
    regression = missing(plain, offsets).weighted_by(floored(white, fitted(white, Model()))[1])
    base = fitted(regression, Model())
    return offset_sizes(regression.equations, regression.weighting, base.model, base.x, regression.learning)


def test_offsets_of_one_joint_are_found_with_their_size(plain):
    offsets = np.zeros((TRIALS, 2))
    offsets[:, 0] = 0.5 * np.random.default_rng(4).normal(size=TRIALS)
    found = found_in(plain, offsets)
    # A median absolute deviation of 15 numbers is known to 30 % (Rousseeuw and Croux 1993), twice that is allowed.
    assert found[0] == pytest.approx(0.5, rel=0.6)
    assert found[1] < 0.2 * found[0]  # what the base parameters that both equations have are bent by


def test_without_any_there_are_none(plain):
    np.testing.assert_array_equal(found_in(plain, np.zeros((TRIALS, 2))), 0.0)


def test_what_all_trials_share_or_drifts_or_changes_once_is_no_offset(plain):
    one_by_one = np.arange(TRIALS)[:, None] * np.ones(2)
    for offsets in (np.full((TRIALS, 2), 0.5), 0.5 * (one_by_one > 9), 0.02 * one_by_one, 0.5 * (one_by_one == 5)):
        assert np.all(found_in(plain, offsets) < 0.2 * np.max(offsets))


@given(st.floats(-5.0, 5.0))
@settings(max_examples=5, deadline=None, derandomize=True)
def test_a_constant_more_in_all_trials_changes_no_scatter(plain, more):
    rng = np.random.default_rng(5)
    motions = [replace(one, u=one.u + rng.normal()) for one in plain.motions]
    shifted = [replace(one, u=one.u + more) for one in motions]
    x = fitted(plain, Model()).x
    sizes = [offset_sizes(plain.equations, plain.weighting, Model(), x, some) for some in (motions, shifted)]
    np.testing.assert_allclose(*sizes, rtol=1e-6)


@given(st.integers(0, 1000), st.floats(0.5, 3.0))
@settings(max_examples=20, deadline=None, derandomize=True)
def test_the_scatter_is_what_uncertainty_does_not_explain(seed, size):
    rng = np.random.default_rng(seed)
    variances = np.full(2000, 0.04)
    assert _scatter(rng.normal(0.0, np.hypot(size, 0.2), 2000), variances) == pytest.approx(size, rel=0.15)
    assert _scatter(rng.normal(0.0, 0.2, 2000), variances) == 0.0
    assert _scatter(rng.normal(0.0, size, 1), variances[:1]) == 0.0
    assert _scatter(rng.normal(0.0, size, 3), np.full(3, np.inf)) == 0.0
