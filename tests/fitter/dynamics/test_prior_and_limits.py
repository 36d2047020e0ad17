"""Prior and limits of a search."""

import numpy as np
import pytest

from fitter.dynamics.prior_and_limits import Allowed


def circle(x):
    """Return the limit of the unit circle, 1 - |x|^2, and its slopes."""
    return np.array([1.0 - x @ x]), -2.0 * x[None]


def test_bounds_and_limits_are_one_set_of_inequalities():
    allowed = Allowed(low=np.array([-2.0, -np.inf]), high=3.0, limits=circle)
    x, scale = np.array([0.5, 0.0]), np.array([0.1, 1.0])
    g, G = allowed.inequalities(x, scale, inside=0.25)
    assert g == pytest.approx([0.75 - 0.25, 25.0, 25.0, 3.0])
    assert np.array_equal(G, [[-1.0, 0.0], [10.0, 0.0], [-10.0, 0.0], [0.0, -1.0]])
    assert allowed.admits(x)
    assert not allowed.admits(np.array([1.0, 0.1]))


def test_without_any_everything_is_admitted():
    allowed = Allowed()
    g, G = allowed.inequalities(np.zeros(2), np.ones(2))
    assert len(g) == len(G) == 0
    assert allowed.prior(np.ones(2), np.zeros(2)) == pytest.approx(0.0)


def test_the_prior_is_in_its_standard_errors():
    prior = Allowed(prior_std=np.array([0.5, np.inf])).prior(np.array([1.0, 7.0]), np.zeros(2))
    assert prior.tolist() == [-2.0, 0.0]
