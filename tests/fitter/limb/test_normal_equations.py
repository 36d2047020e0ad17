"""The t distribution of a marker's error, against scipy's density."""

import numpy as np
import pytest
import scipy.stats

from fitter.limb.marker_observations import FREEDOM
from fitter.limb.normal_equations import t_cost, t_weight


@pytest.mark.parametrize("variance", [1e-6, 0.3])
def test_the_cost_is_minus_twice_the_log_density(variance):
    t = scipy.stats.multivariate_t(np.zeros(3), variance * np.eye(3), df=FREEDOM)
    for distance in np.sqrt(variance) * np.array([[0.1, 0.0, 0.0], [1.0, -2.0, 0.5], [9.0, 9.0, 9.0]]):
        expected = -2.0 * (t.logpdf(distance) - t.logpdf(np.zeros(3)))
        assert t_cost(float(distance @ distance), variance) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("squares", [0.0, 0.2, 40.0])
def test_the_weight_is_the_slope_of_the_cost(squares):
    step, variance = 1e-6, 0.3
    slope = (t_cost(squares + step, variance) - t_cost(squares, variance)) / step
    assert t_weight(squares, variance) == pytest.approx(slope, rel=1e-4)
