"""Disjoint parts of recordings."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.functional.disjoint import LEAST_PARTS, coverage_factor, disjoint_parts, jackknife, rms_apart


@given(st.lists(st.tuples(st.integers(0, 300), st.floats(0.0, 1.0)), min_size=1, max_size=9), st.integers(0, 99))
def test_no_part_reaches_into_two_trials_and_no_unusable_frame_is_in_one(lengths, seed):
    rng = np.random.default_rng(seed)
    usable = [rng.uniform(size=n) < share for n, share in lengths]
    parts = disjoint_parts(usable)
    of_trial = np.concatenate([np.full(len(u), i) for i, u in enumerate(usable)])
    assert np.all(parts.part[~np.concatenate(usable)] == -1)
    for part in range(parts.n_part):
        assert len(np.unique(of_trial[parts.part == part])) == 1
    assert set(parts.part[parts.part >= 0]) == set(range(parts.n_part))
    assert set(parts.trial[parts.trial >= 0]) == set(range(parts.n_trial))


@pytest.mark.parametrize("trials", [1, 2, 3, 4, 5, 6, 9])
def test_there_are_parts_enough(trials):
    parts = disjoint_parts([np.ones(500, dtype=bool)] * trials)
    assert LEAST_PARTS <= parts.n_part <= 2 * LEAST_PARTS
    assert parts.n_trial == max(trials, 2)
    counts = np.bincount(parts.part)
    assert counts.max() - counts.min() <= 2


def test_the_jackknife_of_a_mean_is_the_variance_of_a_mean():
    x = np.random.default_rng(1).normal(size=(8, 3))
    covariance = jackknife(lambda use: x[use].mean(axis=0), 8)
    assert np.allclose(covariance, np.cov(x.T) / 8)


def test_one_part_says_nothing():
    assert np.isnan(jackknife(lambda use: np.zeros(2), 1)).all()
    assert np.isnan(coverage_factor(1))
    assert np.isnan(rms_apart([np.zeros(3)]))


def test_two_answers_are_apart_by_their_distance():
    assert rms_apart([np.array([0.0, 0.0, 0.0]), np.array([0.003, 0.004, 0.0])]) == pytest.approx(0.005)
