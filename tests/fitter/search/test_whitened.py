"""Sums turned back into a least-squares problem."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.search.whitened import whiten


def of(A, b):
    return whiten(A.T @ A, A.T @ b, np.einsum("ki,ki->i", b, b))


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 6), st.integers(1, 3), st.integers(0, 999))
def test_keeps_the_cost(n_column, n_right, seed):
    rng = np.random.default_rng(seed)
    A, b, x = rng.normal(size=(40, n_column)), rng.normal(size=(40, n_right)), rng.normal(size=(n_column, n_right))
    A *= 10.0 ** rng.uniform(-3, 3, n_column)
    w = of(A, b)
    assert np.allclose(np.sum((w.W @ x - w.z) ** 2, axis=0) + w.rest, np.sum((A @ x - b) ** 2, axis=0))
    assert np.allclose(w.inverse() @ (A.T @ A)[np.ix_(w.kept, w.kept)], np.eye(n_column), atol=1e-7)
    assert np.allclose(w.solve(np.zeros((n_column, n_right))), np.linalg.lstsq(A, b)[0], rtol=1e-6)
    assert np.isclose(w.condition_number(), np.linalg.cond(A / np.linalg.norm(A, axis=0)), rtol=1e-6)


def test_digits_survive_near_the_optimum():
    """A plain difference of sums is lost in rounding here; the whitened cost is not."""
    rng = np.random.default_rng(0)
    A, x = rng.normal(size=(1000, 4)), rng.normal(size=(4, 1))
    w = of(A, A @ x)
    off = x + 1e-9
    assert np.isclose(np.sum((w.W @ off - w.z) ** 2), np.sum((A @ (off - x)) ** 2), rtol=1e-4)


def test_a_column_that_says_nothing_new_is_folded():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(50, 4))
    A[:, 1] = 2.0 * A[:, 3]
    A = np.column_stack([A, np.zeros(50)])
    b = A @ np.array([[1.0], [2.0], [3.0], [4.0], [5.0]])
    w = of(A, b)
    assert len(w.kept) == 3
    assert 4 in w.folded
    pair = next(k for k in (1, 3) if k in w.kept)
    assert np.flatnonzero(np.abs(w.dependence()).max(axis=1) > 1e-6).tolist() == [w.kept.tolist().index(pair)]
    prior = np.array([[0.0], [2.0], [0.0], [4.0], [7.0]])
    assert np.allclose(w.solve(prior)[:, 0], [1.0, 2.0, 3.0, 4.0, 7.0], atol=1e-6)


def test_nothing_at_all():
    w = whiten(np.zeros((3, 3)), np.zeros((3, 1)), np.ones(1))
    assert w.W.shape == (0, 3)
    assert w.folded.tolist() == [0, 1, 2]
    assert w.rest.tolist() == [1.0]
