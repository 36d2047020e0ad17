"""Noise in the regressor does not pass for physics."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.errors_in_variables import added, noise_of
from fitter.diagnosis.least_squares import compensated


@given(st.integers(0, 1000), st.floats(0.05, 0.4))
@settings(max_examples=30, deadline=None)
def test_what_noise_takes_away_is_put_back(seed, size):
    """Attenuated least squares is off by the ratio of noise to signal; compensated, by chance alone."""
    rng = np.random.default_rng(seed)
    true, n = np.array([2.0, -1.0, 0.5]), 20_000
    A = rng.standard_normal((n, 3))
    loud = A + np.column_stack([size * rng.standard_normal(n), np.zeros(n), np.zeros(n)])
    y = A @ true + 0.1 * rng.standard_normal(n)
    noise = noise_of(size * rng.standard_normal((n, 1, 3)) * [1.0, 0.0, 0.0], np.zeros((n, 1)))
    gram, rhs = loud.T @ loud, loud.T @ y
    plain = np.linalg.solve(gram, rhs)
    assert plain[0] == pytest.approx(2.0 / (1.0 + size**2), rel=0.02)
    found = compensated(gram, rhs, noise.gram.sum(axis=0), noise.rhs.sum(axis=0))
    np.testing.assert_allclose(found, true, atol=0.02 + 0.05 * size)


def test_without_noise_it_is_least_squares_and_the_shortest_answer():
    rng = np.random.default_rng(1)
    A = rng.standard_normal((60, 3))
    A = np.column_stack([A, A[:, 0]])
    y = rng.standard_normal(60)
    found = compensated(A.T @ A, A.T @ y, np.zeros((4, 4)), np.zeros(4))
    np.testing.assert_allclose(found, np.linalg.lstsq(A, y, rcond=1e-9)[0], atol=1e-9)


def test_where_there_is_nothing_but_noise_nothing_is_blown_up():
    rng = np.random.default_rng(2)
    A = rng.standard_normal((200, 2))
    y = rng.standard_normal(200)
    plain = np.linalg.lstsq(A, y, rcond=None)[0]
    found = compensated(A.T @ A, A.T @ y, A.T @ A, np.zeros(2))
    np.testing.assert_allclose(found, 2.0 * plain, rtol=1e-9)


def test_noise_of_several_motions_adds_up():
    rng = np.random.default_rng(3)
    columns, target = rng.standard_normal((40, 2, 3)), rng.standard_normal((40, 2))
    parts = [noise_of(columns[half], target[half]) for half in (slice(0, 15), slice(15, 40))]
    whole, sum_ = noise_of(columns, target), added(parts)
    x = rng.standard_normal(3)
    np.testing.assert_allclose(sum_.sum_of_squares(x), whole.sum_of_squares(x))
    np.testing.assert_allclose(whole.sum_of_squares(x), np.sum((columns @ x - target) ** 2, axis=0))
