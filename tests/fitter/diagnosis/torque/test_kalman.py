"""A random walk's filter against its closed form, and columns one by one."""

import numpy as np
import pytest

from fitter.diagnosis.torque.kalman import Filter, gains, response

N = 40


def random_walk() -> Filter:
    F, Q, P, C, known = np.eye(1), np.eye(1), np.eye(1), np.ones((N, 1)), np.ones(N, dtype=bool)
    known[7] = False
    variance = np.full(N, 2.0)
    return Filter(F, Q, P, C, variance, *gains(F, Q, P, C, variance, known, 1, np.zeros((0, 1, 1))), known)


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


@pytest.mark.parametrize(("length", "first"), [(1, 0), (3, 5), (4, N - 4)])
def test_a_response_is_what_follows_from_a_column_until_it_has_settled(length, first):
    """The filter forgets a random walk by one half a row: to a millionth in twenty rows."""
    kalman = random_walk()
    column = np.zeros(N)
    column[first : first + length] = 1.0
    whole = kalman.innovations(column)[first:]
    arguments = kalman.F, kalman.C, kalman.gain, kalman.S, kalman.known, np.ones(length), first, 1e-6
    found = response(*arguments)
    assert found == pytest.approx(whole[: len(found)])
    assert np.all(np.abs(whole[len(found) :]) < 1e-6 * np.max(np.abs(whole)))
    assert len(found) <= 2 * length + 22


def slow_and_fast() -> tuple[np.ndarray, ...]:
    """Return F, Q, P, C and variance of a constant in proportion to a signal beside an autoregressive process."""
    signal = 1.0 + 0.5 * np.sin(np.arange(N))
    return (
        np.diag([1.0, 0.6]),
        np.diag([0.0, 0.5]),
        np.diag([4.0, 1.0]),
        np.stack([signal, np.ones(N)], 1),
        np.ones(N),
    )


def test_the_gain_of_an_outlier_is_that_of_as_much_more_new_noise():
    """Eq. (m.1b) against the covariance form, with the row's process and white noise divided by its weight."""
    F, Q, P, C, variance = slow_and_fast()
    known, nu, at = np.ones(N, dtype=bool), 4.0, 20
    kalman = Filter(F, Q, P, C, variance, *gains(F, Q, P, C, variance, known, 2, np.zeros((0, 2, 2))), known)
    r = np.zeros(N)
    r[at] = 30.0
    weighted = kalman.weighted(r, nu)
    weight = nu / (nu + r[at] ** 2 / kalman.S[at])
    covariance = P
    for k in range(at):
        gain = covariance @ C[k] / (C[k] @ covariance @ C[k] + variance[k])
        covariance = F @ (covariance - np.outer(gain, C[k] @ covariance)) @ F.T + Q
    louder = covariance + (1.0 / weight - 1.0) * Q
    gain = louder @ C[at] / (C[at] @ louder @ C[at] + variance[at] / weight)
    assert weighted.gain[at] == pytest.approx(gain)
    assert weighted.gain[:at] == pytest.approx(kalman.gain[:at])
    assert abs(weighted.gain[at, 0]) < 0.1 * abs(kalman.gain[at, 0])


def test_without_tails_no_row_has_a_weight_of_its_own():
    F, Q, P, C, variance = slow_and_fast()
    known = np.ones(N, dtype=bool)
    kalman = Filter(F, Q, P, C, variance, *gains(F, Q, P, C, variance, known, 2, np.zeros((0, 2, 2))), known)
    r = np.random.default_rng(2).normal(size=N)
    assert kalman.weighted(r, 1e12).gain == pytest.approx(kalman.gain)


def test_innovations_are_residuals_from_the_expected_states():
    kalman = random_walk()
    r = np.random.default_rng(3).normal(size=N)
    expected = np.sum(kalman.C * kalman.predicted(r), axis=1)
    e = np.where(kalman.known, (r - expected) / np.sqrt(kalman.S), 0.0)
    assert kalman.innovations(r) == pytest.approx(e)
