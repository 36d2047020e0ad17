"""Bounds of the geometry's search: around the prior, as given, and never the wrong way round."""

import numpy as np
import pytest

from fitter.kinematics.search_bounds import LONGEST_LINK_M, search_bounds
from fitter.kinematics.tip_basis import geometry_names
from limbcal.errors import ConfigError

NAMES = geometry_names(2)


def test_the_prior_lies_within_and_lengths_reach_from_none_to_the_longest():
    prior = np.array([0.1, 0.3, -0.2, 0.05, 1.0, -0.3, 1.4, 0.6, 0.0, -1.0])
    low, high = search_bounds(NAMES, prior, {})
    assert np.all(low <= prior) and np.all(prior <= high)
    lengths = [k for k, name in enumerate(NAMES) if name.startswith("a") and not name.startswith("alpha")]
    assert low[lengths].tolist() == [0.0, 0.0]
    assert high[lengths].tolist() == [max(LONGEST_LINK_M, 2.0 * prior[k]) for k in lengths]


def test_given_bounds_are_taken_and_wrong_ones_refused():
    low, high = search_bounds(NAMES, np.zeros(10), {NAMES[1]: (0.2, 0.4)})
    assert (low[1], high[1]) == (0.2, 0.4)
    for wrong in ((0.4, 0.2), (0.0, np.inf), (np.nan, 1.0)):
        with pytest.raises(ConfigError, match=f"bounds of {NAMES[1]}"):
            search_bounds(NAMES, np.zeros(10), {NAMES[1]: wrong})
