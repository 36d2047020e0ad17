"""A random walk's filter against its closed form, and columns one by one."""

import numpy as np
import pytest

from fitter.diagnosis.torque.kalman import Filter, gains

N = 40


def random_walk() -> Filter:
    F, Q, P, C, known = np.eye(1), np.eye(1), np.eye(1), np.ones((N, 1)), np.ones(N, dtype=bool)
    known[7] = False
    variance = np.full(N, 2.0)
    return Filter(F, Q, P, C, variance, *gains(F, Q, P, C, variance, known, 1), known)


def test_the_gain_of_a_random_walk_is_that_of_the_riccati_equation():
    kalman = random_walk()
    prior = (1.0 + np.sqrt(1.0 + 4.0 * 2.0)) / 2.0  # p = p - p^2 / (p + 2) + 1
    assert kalman.S[-1] == pytest.approx(prior + 2.0)
    assert kalman.gain[-1, 0] == pytest.approx(prior / (prior + 2.0))
    assert (kalman.gain[7, 0], kalman.S[7]) == (0.0, 1.0)


def test_innovations_are_linear_and_begin_at_a_column():
    kalman = random_walk()
    columns = np.random.default_rng(1).normal(size=(N, 2))
    columns[:10, 1] = 0.0
    first, second = (kalman.innovations(column) for column in columns.T)
    assert first + 2.0 * second == pytest.approx(kalman.innovations(columns @ [1.0, 2.0]))
    assert kalman.innovations(columns[10:15, 1], 10) == pytest.approx(second[10:15])
