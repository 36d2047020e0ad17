"""Filters side by side: the density they foretell, whom they believe, and what the mixture is."""

import numpy as np
import pytest
from scipy.stats import multivariate_t

from arm.model import Arm
from tracking.kalman.kalman_step import Taken
from tracking.kalman.model_bank import LONG_S, SHORT_S, ahead, bank_of, mix, take_robustly, weigh
from tracking.model.course import Course
from tracking.model.discrepancy import FREEDOM
from tracking.model.expected_readings import observe, room_of
from tracking.model.observation import observation_of


@pytest.fixture
def bank(vertical_arm: Arm):
    of, _ = observation_of(vertical_arm, base=True, lack=True)
    known = observation_of(vertical_arm)[1]
    return of, bank_of(of, np.zeros(known), 1e-3 * np.eye(known), True)


def taken_of(size: int, n_channel: int, n: int) -> Taken:
    rows = n_channel + n
    return Taken(np.zeros((n_channel, size)), np.zeros((rows, size)), np.zeros(rows), np.zeros(rows))


def course_of(n_channel: int, readings: np.ndarray) -> Course:
    there, ones = np.ones(2, dtype=np.bool_), np.ones((2, n_channel))
    noise = np.full(n_channel, 1e-2)
    zeros = np.zeros((2, 2))
    return Course(
        0.01, np.tile(readings, (2, 1)), there, noise, noise, np.ones(2), zeros, ones, zeros, np.zeros(2)
    )


@pytest.mark.parametrize("off", [0.0, 0.3, 30.0])
def test_a_sensors_readings_have_students_density_and_outliers_little_weight(bank, off: float) -> None:
    """Against scipy, of the first sensor; and a reading that is far off moves hardly anything."""
    of, models = bank
    size, n_channel = models.mean.size, 12
    x, P = models.x[7].copy(), models.P[7].copy()
    expected, slope = np.empty(n_channel), np.zeros((n_channel, size))
    observe(of, room_of(2), x, expected, slope)
    of = of._replace(link=of.link[:1])
    readings = expected.copy()
    readings[:3] += off * np.array([1.0, -0.5, 0.2])
    course = course_of(n_channel, readings)._replace(noise=np.full(3, 1e-2))
    S = slope[:3] @ P @ slope[:3].T + 1e-2 * np.eye(3)
    before = x.copy()
    density = take_robustly(of, room_of(2), course, x.copy(), x, P, taken_of(size, n_channel, 2))
    student = multivariate_t(np.zeros(3), S, FREEDOM)
    away = student.logpdf(readings[:3] - expected[:3]) - student.logpdf(np.zeros(3))
    level = -0.5 * np.linalg.slogdet(S)[1]
    assert density == pytest.approx(level + away, abs=1e-6)
    assert np.abs(x - before).max() < 0.5
    assert np.linalg.eigvalsh(P).min() > -1e-12


def test_evidence_of_a_moment_counts_at_once_and_that_of_seconds_until_they_are_gone(bank) -> None:
    _, models = bank
    dt, small, large = 0.01, 0, 3
    calm, busy = np.full(10, -20.0), np.full(10, -40.0)
    calm[small], calm[large] = 10.0, 0.0  # at ease it is as well to lack little
    busy[small], busy[large] = -30.0, 0.0
    for _ in range(round(3 * LONG_S / dt)):
        weigh(models, calm, dt)
    assert models.weight[small] > 0.99
    for _ in range(round(SHORT_S / dt)):
        weigh(models, busy, dt)
    assert models.weight[large] > 0.99
    for _ in range(round(LONG_S / dt)):
        weigh(models, busy, dt)
    for _ in range(round(2 * SHORT_S / dt)):
        weigh(models, calm, dt)
    assert models.weight[large] > 0.99


def test_a_mixture_knows_less_than_filters_that_differ(bank) -> None:
    _, models = bank
    models.weight[:] = 0.0
    models.weight[[0, 1]] = 0.5
    models.x[0, 0], models.x[1, 0] = -1.0, 1.0
    mix(models)
    assert models.mean[0] == pytest.approx(0.0)
    assert models.covariance[0, 0] == pytest.approx(1.0 + 1e-3)


def test_joints_are_ahead_by_their_speed_and_acceleration() -> None:
    mean = np.array([1.0, 2.0, 4.0, 0.0, -1.0, 0.0, 0.5])
    root = np.random.default_rng(0).standard_normal((7, 7))
    covariance = root @ root.T
    states, variances = np.empty((2, 7)), np.empty((2, 2))
    ahead(mean, covariance, np.array([0.0, 0.1]), states, variances)
    np.testing.assert_allclose(states[0], mean)
    np.testing.assert_allclose(states[1], [1.22, 2.4, 4.0, -0.1, -1.0, 0.0, 0.5])
    slope = np.array([1.0, 0.1, 0.005])
    np.testing.assert_allclose(variances[1], [slope @ covariance[i : i + 3, i : i + 3] @ slope for i in (0, 3)])
