"""What trials are typically left with is moved far by none of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.typical import typical

RATIOS = st.lists(st.floats(0.1, 100.0), min_size=1, max_size=30)


def test_what_is_typical_is_not_moved_far_by_one_trial():
    squares = np.full(20, 200.0)
    assert typical(squares, np.full(20, 100.0)) == pytest.approx(2.0)
    squares[7] *= 1e4
    assert typical(squares, np.full(20, 100.0)) == pytest.approx(2.0 * 1e4**0.05)


@given(RATIOS, st.floats(0.1, 10.0), st.permutations(range(30)))
def test_it_lies_among_them_in_any_order_and_unit(ratios, factor, order):
    told = np.linspace(50.0, 90.0, len(ratios))
    squares = np.array(ratios) * told
    found = typical(squares, told)
    assert min(ratios) * (1.0 - 1e-9) <= found <= max(ratios) * (1.0 + 1e-9)
    assert typical(factor * squares, told) == pytest.approx(factor * found)
    some = [k for k in order if k < len(ratios)]
    assert typical(squares[some], told[some]) == pytest.approx(found)


def test_a_trial_that_is_left_with_nothing_is_no_exception():
    assert 0.0 < typical(np.array([0.0, 1.0]), np.ones(2)) < 1.0
