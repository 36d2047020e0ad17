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


def lacking(regression, offsets):
    """Return equations whose drives missed white torques, and a constant one (n_trial, n_joint) in each trial."""
    rng = np.random.default_rng(3)
    both = zip(regression.motions, [*offsets, *offsets], strict=True)
    motions = [replace(one, u=one.u + off + WHITE * rng.normal(size=one.u.shape)) for one, off in both]
    return regression_of(regression.arm, motions)


def found_in(regression):
    """Return the offsets of a run under weights with its floor, and these weights."""
    for _ in range(2):
        own, weighted, _ = floored(regression, fitted(regression, Model()))
        regression = regression.weighted_by(weighted)
        regression.sensors = own
    return regression.weighting.offsets, regression


def test_offsets_of_one_joint_are_found_with_their_size(plain):
    offsets = np.zeros((TRIALS, 2))
    offsets[:, 0] = 0.5 * np.random.default_rng(4).normal(size=TRIALS)
    found, _ = found_in(lacking(plain, offsets))
    # A median absolute deviation of 15 numbers is known to 30 % (Rousseeuw and Croux 1993), twice that is allowed.
    assert found[0] == pytest.approx(0.5, rel=0.6)
    assert found[1] < 0.1 * found[0]


def test_without_any_there_are_none(plain):
    found, _ = found_in(lacking(plain, np.zeros((TRIALS, 2))))
    np.testing.assert_array_equal(found, 0.0)


def test_what_all_trials_share_or_drifts_or_changes_once_is_no_offset(plain):
    one_by_one = np.arange(TRIALS)[:, None] * np.ones(2)
    for offsets in (np.full((TRIALS, 2), 0.5), 0.5 * (one_by_one > 9), 0.02 * one_by_one, 0.5 * (one_by_one == 5)):
        found, _ = found_in(lacking(plain, offsets))
        assert np.all(found < 0.1 * np.max(offsets))


def test_equations_with_offsets_say_no_more_of_a_constant_than_its_scatter(plain):
    offsets = 0.5 * np.random.default_rng(4).normal(size=(TRIALS, 2))
    found, regression = found_in(lacking(plain, offsets))
    motion = regression.learning[0]
    constant = regression.weighting.filtered_at(motion, 0, np.full((len(motion.t), 1), found[0]))
    assert float(np.sum(constant**2)) < 1.0  # one standard deviation of it has the information of one
    assert float(np.sum(regression.weighting.whitened_at(motion, 0, np.ones((len(motion.t), 1))) ** 2)) > 10.0


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
