"""The adjoint against dense matrices, and against the transpose of what the filter does."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Arm
from tracking.kalman.kalman_step import predict
from tracking.model.course import Course
from tracking.model.observation import observation_of
from tracking.smoother.adjoint import carry_back, reported_variance, shrink_back

N, DT = 3, 0.01


def course(n_channel: int) -> Course:
    ones, none = np.ones((N, n_channel)), np.zeros((N, 2))
    noise, wander, push, rate = np.full(n_channel, 0.01), np.full(n_channel, 0.2), np.full(2, 400.0), np.ones(2)
    lack = np.full(n_channel, 0.1)
    return Course(
        DT, 9.0 * ones, np.ones(N, dtype=bool), noise, wander, push, none, ones, none, rate, 0.5, lack, 0.3
    )


def positive(rng: np.random.Generator, size: int) -> np.ndarray:
    root = rng.standard_normal((size, size))
    return root @ root.T / size


@pytest.mark.parametrize("kind", ["plain", "AC-coupled", "base and lack"])
def test_carrying_back_is_the_transpose_of_predicting(vertical_arm: Arm, kind: str) -> None:
    arm = vertical_arm
    if kind == "AC-coupled":
        arm = replace(arm, sensors=tuple(replace(one, highpass_hz=0.5) for one in arm.sensors))
    of, size = observation_of(arm, base=kind == "base and lack", lack=kind == "base and lack")
    one, rng = course(12), np.random.default_rng(1)
    start = rng.standard_normal(size)
    later, nothing = rng.standard_normal(size), np.zeros((size, size))

    def predicted(x: np.ndarray) -> np.ndarray:
        after = x.copy()
        predict(of, one, 1, after, nothing.copy())
        return after

    back, shrink = later.copy(), positive(rng, size)
    whole = shrink.copy()
    carry_back(of, one, 1, start, back, shrink, True)
    steps = 1e-6 * np.eye(size)
    F = np.stack([(predicted(start + h) - predicted(start - h)) / 2e-6 for h in steps], axis=1)
    np.testing.assert_allclose(back, F.T @ later, atol=1e-7)
    np.testing.assert_allclose(shrink, F.T @ whole @ F, atol=1e-7)


def test_a_reading_shrinks_by_josephs_form() -> None:
    rng, size, total = np.random.default_rng(2), 7, 1.7
    shrink, gain = positive(rng, size), rng.standard_normal(size)
    columns = np.array([1, 4, 5])
    h = np.zeros(size)
    h[columns] = rng.standard_normal(3)
    left = np.eye(size) - np.outer(gain, h)
    expected, square = left.T @ shrink @ left + np.outer(h, h) / total, gain @ shrink @ gain + 1.0 / total
    assert shrink_back(shrink, gain, total, h, columns) == pytest.approx(square)
    np.testing.assert_allclose(shrink, expected, atol=1e-12)


def test_a_variance_without_digits_is_no_number() -> None:
    rng, size = np.random.default_rng(3), 6
    P = positive(rng, size)
    shrink = 0.5 * np.linalg.inv(P)
    variance = np.empty(3)
    reported_variance(np.array([0, 2, 5]), P, shrink, variance)
    np.testing.assert_allclose(variance, np.diag(P - P @ shrink @ P)[[0, 2, 5]])
    reported_variance(np.array([0, 2, 5]), P, 2.0 * shrink, variance)  # later readings leave nothing
    assert np.isnan(variance).all()
