"""The covariance of draws, and what they do not explain."""

import numpy as np

from fitter.search.drawn import covariance_of


def test_draws_that_explain_all_of_it_are_all():
    rng = np.random.default_rng(0)
    departures = rng.normal(size=(500, 2)) * [1.0, 3.0]
    left = np.full(500, 2.0)
    covariance = covariance_of(departures, left, 1.9, np.full((2, 2), 1e6))
    np.testing.assert_allclose(covariance, np.diag([1.0, 9.0]), atol=0.6)


def test_what_they_do_not_explain_is_added():
    departures, left = np.zeros((4, 1)), np.ones(4)
    assert covariance_of(departures, left, 10.0, np.array([[2.0]])) == [[0.9 * 2.0]]
    assert covariance_of(departures, left, 10.0, np.array([[np.nan]])) == [[0.0]]
