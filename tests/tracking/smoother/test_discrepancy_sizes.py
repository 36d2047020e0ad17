"""Sizes of what the model lacks, learnt from draws whose sizes are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from arm.arm_file import load_arm
from tracking.model.course import Course
from tracking.model.observation import observation_of
from tracking.smoother.discrepancy_sizes import noise_variances, sizes_of
from tracking.smoother.smoothing_pass import Pass

N, DT = 4000, 0.01
ARM = load_arm("dd-arm")
OF = observation_of(replace(ARM, sensors=ARM.sensors[:2]))[0]


def course(n_channel: int = 6, std: float = 0.1) -> Course:
    ones = np.ones((N, n_channel))
    return Course(
        DT,
        0.0 * ones,
        np.ones(N, dtype=bool),
        np.full(n_channel, std**2),
        np.zeros(n_channel),
        np.full(2, 2500.0),
        np.zeros((N, 2)),
        ones,
        np.zeros((N, 2)),
        np.zeros(2),
    )


def found(noise: np.ndarray, before: np.ndarray) -> Pass:
    """Return a pass that has used nothing of the readings: their noise is what it leaves."""
    return Pass(np.zeros((N, 1)), np.zeros((N, 1)), noise / before, 1.0 / before * np.ones_like(noise))


def test_noise_that_grows_is_found_where_it_grows() -> None:
    rng, one = np.random.default_rng(0), course()
    std = np.where(np.arange(N) < N // 2, 0.2, 2.0)[:, None]
    noise = std * rng.standard_normal((N, 6))
    variance = noise_variances(OF, one, found(noise, one.noise * one.doubt))
    calm, loud = variance[200 : N // 2 - 200], variance[N // 2 + 200 : -200]
    assert np.sqrt(np.median(calm)) == pytest.approx(0.2, rel=0.2)
    assert np.sqrt(np.median(loud)) == pytest.approx(2.0, rel=0.2)


def test_a_stroke_counts_for_its_instant_and_its_sensor() -> None:
    rng, one = np.random.default_rng(1), course()
    noise = 0.1 * rng.standard_normal((N, 6))
    noise[2000, :3] += 30.0
    variance = noise_variances(OF, one, found(noise, one.noise * one.doubt))
    assert variance[2000, :3].min() > 100.0 and variance[2000, 3:].max() < 1.0
    assert np.median(variance) == pytest.approx(0.01, rel=0.3)


def test_noise_is_never_less_than_the_sensors_own() -> None:
    one = course(std=0.5)
    noise = 0.01 * np.random.default_rng(2).standard_normal((N, 6))
    np.testing.assert_array_equal(
        noise_variances(OF, one, found(noise, one.noise * one.doubt)), one.noise * one.doubt
    )


def test_lost_readings_have_no_say() -> None:
    rng, one = np.random.default_rng(3), course()
    noise = 0.3 * rng.standard_normal((N, 6))
    one.present[1000:3000] = False
    noise[1000:3000] = 1e6
    variance = noise_variances(OF, one, found(noise, one.noise * one.doubt))
    assert np.sqrt(np.median(variance[one.present])) == pytest.approx(0.3, rel=0.2)


def test_sizes_are_expected_squares(dd_arm) -> None:
    """Of the states and of their variances: one for all channels, one for all joints that turn."""
    of, size = observation_of(dd_arm, base=True, lack=True)
    rng = np.random.default_rng(4)
    states, variance = np.zeros((N, size)), np.zeros((N, len(of.reported)))
    lack, base = slice(of.lack_column, of.lack_column + 12), slice(of.base_column, of.base_column + 3)
    states[:, lack] = 0.3 * rng.standard_normal((N, 12))
    states[:, base] = 1.2 * rng.standard_normal((N, 3))
    states[:, 1], states[:, 4] = 2.0, 1.0
    variance[:, of.reported == of.lack_column + 3] = 12 * 0.4**2  # all of it in one channel
    variance[:, of.reported == 1] = 1.0
    sizes = sizes_of(of, Pass(states, variance, states, states), np.array([True, True]), 0.1)
    assert sizes.lack_std == pytest.approx(0.5, rel=0.02)
    assert sizes.base_std == pytest.approx(1.2, rel=0.02)
    np.testing.assert_allclose(sizes.speed_std, np.sqrt((4.0 + 1.0 + 1.0) / 2.0))


def test_the_scale_of_all_instants_is_students_likeliest() -> None:
    """An instant alone, six readings, is pulled to it by four degrees of freedom; one axis in three is loud."""
    rng, one = np.random.default_rng(5), course()._replace(dt=1.0)
    noise = rng.standard_t(4.0, (N, 6)) * np.tile([1.0, 0.3, 0.3], 2)
    s = np.square(noise).reshape(N, 2, 3).sum(axis=2)

    def unlikely(log_scale: float) -> float:
        return float(np.sum(1.5 * log_scale + 3.5 * np.log1p(s / (4.0 * np.exp(log_scale)))))

    overall = np.exp(minimize_scalar(unlikely, bounds=(-5.0, 5.0), method="bounded", options={"xatol": 1e-9}).x)
    variance = noise_variances(OF, one, found(noise, one.noise * one.doubt))
    for k in range(0, N, 500):

        def off(v: float, k: int = k) -> float:
            return (4.0 * overall + 2.0 * np.mean(7.0 * s[k] / (4.0 + s[k] / v))) / 10.0 - v

        local = brentq(off, 1e-6, 1e3)
        weighed = local * (4.0 + s[k] / local) / 7.0
        np.testing.assert_allclose(variance[k], np.repeat(weighed, 3), rtol=0.02)
