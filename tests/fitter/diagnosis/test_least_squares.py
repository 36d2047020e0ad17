"""Normal equations, whatever their columns' units, and the shortest answer where columns depend on one another."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.least_squares import own_square, scaled_lstsq, solved


@given(st.integers(0, 1000), st.integers(1, 6), st.floats(1e-6, 1e6))
@settings(max_examples=40)
def test_answers_are_those_of_a_decomposition_in_any_unit(seed, n, unit):
    rng = np.random.default_rng(seed)
    A, y = rng.normal(size=(50, n)), rng.normal(size=50)
    expected = np.linalg.lstsq(A, y, rcond=None)[0]
    A[:, 0] *= unit
    found = scaled_lstsq(A, y)
    np.testing.assert_allclose(found * np.where(np.arange(n) == 0, unit, 1.0), expected, atol=1e-9)


def test_a_column_of_nothing_gets_nothing():
    gram = np.diag([2.0, 0.0])
    np.testing.assert_allclose(solved(gram, np.array([4.0, 0.0])), [2.0, 0.0])


def test_what_the_last_column_has_of_its_own():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(60, 3))
    left = A[:, 2] - A[:, :2] @ np.linalg.lstsq(A[:, :2], A[:, 2], rcond=None)[0]
    assert own_square(A.T @ A) == pytest.approx(left @ left)
    A[:, 2] = A[:, 0] - 2.0 * A[:, 1]
    assert own_square(A.T @ A) == pytest.approx(0.0, abs=1e-9)
