"""Medians and means that ignore NaN, against numpy's on what is finite; without a warning."""

import warnings

import numpy as np

from fitter.limb.nan_statistics import nan_mean, nan_median


def test_they_are_those_of_the_finite_values_and_warn_of_nothing():
    x = np.random.default_rng(0).normal(size=(50, 4))
    x[::3, 1] = np.nan
    x[:, 2] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        median, mean = nan_median(x), nan_mean(x)
    for k in (0, 1, 3):
        finite = x[np.isfinite(x[:, k]), k]
        assert median[k] == np.median(finite)
        np.testing.assert_allclose(mean[k], finite.sum() / len(finite))
    assert np.isnan(median[2]) and np.isnan(mean[2])
