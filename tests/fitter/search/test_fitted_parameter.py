"""Intervals as wide as what is known of a standard error asks for."""

import numpy as np
import pytest

from fitter.search.fitted_parameter import FittedParameter, held_back


def test_few_degrees_of_freedom_widen_an_interval():
    normal, few = FittedParameter(1.0, 0.1, "m", True), FittedParameter(1.0, 0.1, "m", True, 4.0)
    assert normal.ci95 == pytest.approx((0.804, 1.196), abs=1e-4)
    assert few.ci95 == pytest.approx((1.0 - 0.2776, 1.0 + 0.2776), abs=1e-4)


def test_what_is_held_back_claims_nothing():
    (p,) = held_back({"a1": FittedParameter(1.0, 0.1, "m", True, 4.0)}).values()
    assert p.value == 1.0 and np.isnan(p.std) and not p.identifiable and p.ci95 is None
