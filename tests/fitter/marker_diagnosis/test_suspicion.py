"""Densities of errors against scipy's."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from fitter.marker_diagnosis.suspicion import known_in, log_normal


def test_ratios_of_densities_are_scipys():
    rng = np.random.default_rng(1)
    x, (A, B) = rng.normal(size=4), rng.normal(size=(2, 4, 4))
    one, other = A @ A.T + np.eye(4), B @ B.T + np.eye(4)
    expected = multivariate_normal(np.zeros(4), one).logpdf(x) - multivariate_normal(np.zeros(4), other).logpdf(x)
    assert log_normal(x, one) - log_normal(x, other) == pytest.approx(expected)
    assert log_normal(x, -np.eye(4) * [1.0, 1.0, 1.0, -1.0]) == -np.inf


def test_a_marker_is_known_where_its_mean_is_a_number():
    trials = [SimpleNamespace(mean=np.array([[0.0, 0.0, x], [0.0, 0.0, 0.0]])) for x in (0.0, np.nan, 1.0)]
    assert known_in(trials, 0) == [0, 2] and known_in(trials, 1) == [0, 1, 2]
