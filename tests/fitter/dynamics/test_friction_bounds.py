"""A value between uncertain bounds: what is known of it, over many draws of the bounds' errors."""

import numpy as np
import pytest

from fitter.dynamics.friction_bounds import Bound, between, contradict

NOTHING = np.zeros((1, 1))


def bounds(values, noise, slope=0.0):
    return [Bound(float(value), noise, np.array([slope])) for value in values]


def test_between_two_exact_bounds_it_is_anywhere():
    mean, std = between(bounds([1.0], 0.0), bounds([2.0], 0.0), NOTHING)
    assert mean == pytest.approx(1.5, abs=1e-3)
    assert std == pytest.approx(1.0 / np.sqrt(12.0), rel=1e-2)


def test_errors_that_all_bounds_share_are_not_averaged():
    covariance = np.array([[0.04]])
    std = between(bounds([1.0] * 20, 1e-3, 1.0), bounds([1.001] * 20, 1e-3, 1.0), covariance)[1]
    assert std == pytest.approx(0.2, rel=1e-2)


@pytest.mark.parametrize("n", [1, 5, 25])
def test_the_luckiest_of_many_bounds_decides_nothing(n):
    """Bounds at the truth, each with an error of 0.1: the largest lower one is far above it."""
    rng = np.random.default_rng(n)
    inside = []
    for _ in range(200):
        mean, std = between(
            bounds(3.0 + 0.1 * rng.normal(size=n), 0.1), bounds(3.0 + 0.1 * rng.normal(size=n), 0.1), NOTHING
        )
        inside.append(abs(mean - 3.0) <= 1.96 * std)
    assert np.mean(inside) >= 0.92


def test_bounds_contradict_by_more_than_their_errors_alone():
    low, high = bounds([1.0], 0.1), bounds([0.8], 0.1)
    assert not contradict(low, high, NOTHING, 3.0)
    assert contradict(bounds([1.3], 0.1), high, NOTHING, 3.0)
    apart = bounds([1.3], 0.1, 1.0)  # one that hangs on a parameter that is not known well
    assert not contradict(apart, high, np.array([[0.25]]), 3.0)
