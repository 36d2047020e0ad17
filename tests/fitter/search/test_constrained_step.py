"""Least squares under linear inequalities."""

import numpy as np
import pytest

from fitter.search.constrained_step import constrained_step


def test_a_free_optimum_is_that_of_least_squares():
    A, b = np.array([[2.0, 0.0], [0.0, 1.0], [1.0, 1.0]]), np.array([1.0, 2.0, 3.0])
    x, binds = constrained_step(A, b, np.array([10.0]), np.array([[1.0, 1.0]]))
    assert x == pytest.approx(np.linalg.lstsq(A, b, rcond=None)[0]) and not binds.any()


def test_a_limit_that_binds_is_met_exactly_and_the_rest_follows():
    # |x - (3, 1)| least where 1 - x0 - x1 >= 0 is the projection onto that line; the other limit is far away
    x, binds = constrained_step(
        np.eye(2), np.array([3.0, 1.0]), np.array([1.0, 50.0]), np.array([[-1.0, -1.0], [1.0, 0.0]])
    )
    assert x == pytest.approx([1.5, -0.5]) and binds.tolist() == [True, False]


def test_columns_of_very_different_size_do_not_matter():
    A = np.diag([1e6, 1e-3])
    x, _ = constrained_step(A, A @ np.array([1e-6, 1e3]), np.array([0.0]), np.array([[0.0, -1.0]]))
    assert x == pytest.approx([1e-6, 0.0], abs=1e-9)


def test_where_nothing_is_allowed_there_is_no_step():
    x, _ = constrained_step(np.eye(1), np.ones(1), np.array([-1.0, -1.0]), np.array([[1.0], [-1.0]]))
    assert x == pytest.approx([0.0])
