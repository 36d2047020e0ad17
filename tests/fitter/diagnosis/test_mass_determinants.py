"""Determinants and quotients are numpy's; what is no mass has none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.mass_determinants import determinant_slopes, log_determinant, solved_slopes

SEEDS = st.integers(0, 10_000)


def drawn(seed, n_joint, n=7, n_factor=4):
    """Return masses that are not quite symmetric: known, slopes, weight, factors."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n_joint, n_joint))
    known = root @ root.mT + np.eye(n_joint) + 0.1 * (root - root.mT)
    slopes = 0.02 * rng.normal(size=(n, n_joint, n_joint, n_factor))
    return known, slopes, rng.uniform(0.5, 2.0, n), rng.normal(size=n_factor)


@given(SEEDS, st.integers(1, 7))
@settings(max_examples=40, deadline=None)
def test_determinants_are_those_of_numpy(seed, n_joint):
    known, slopes, weight, x = drawn(seed, n_joint)
    expected = weight @ np.linalg.slogdet(known + slopes @ x)[1]
    assert log_determinant(known + slopes @ x, weight) == pytest.approx(expected, abs=1e-9)


@given(SEEDS, st.integers(1, 7))
@settings(max_examples=40, deadline=None)
def test_quotients_are_those_of_numpy(seed, n_joint):
    known, slopes, _, x = drawn(seed, n_joint)
    M, before = known + slopes @ x, slopes.copy()
    expected = np.linalg.solve(M, slopes.reshape(*M.shape[:2], -1)).reshape(slopes.shape)
    np.testing.assert_allclose(solved_slopes(known + slopes @ x, slopes), expected, atol=1e-9)
    np.testing.assert_array_equal(slopes, before)


@given(SEEDS, st.integers(1, 7))
@settings(max_examples=40, deadline=None)
def test_slopes_of_determinants_are_weighted_traces(seed, n_joint):
    known, slopes, weight, x = drawn(seed, n_joint)
    inverse = np.linalg.inv(known + slopes @ x)
    expected = np.einsum("t,tji,tijk->k", weight, inverse, slopes)
    np.testing.assert_allclose(determinant_slopes(known + slopes @ x, weight, slopes), expected, atol=1e-9)


@pytest.mark.parametrize("least", [0.0, -1.0, 1e-7])
def test_what_has_no_mass_in_some_direction_is_impossible(least):
    """Less than half of a double's digits of the largest element counts as none."""
    known, slopes, weight, x = drawn(3, 2)
    known[4] = np.diag([1.0, least])
    slopes[4] = 0.0
    assert log_determinant(known + slopes @ x, weight) == -np.inf
    known[4] = np.diag([1.0, 1e-5])
    assert np.isfinite(log_determinant(known + slopes @ x, weight))
