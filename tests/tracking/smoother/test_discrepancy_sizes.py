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


@pytest.mark.parametrize(("base", "lack"), [(True, True), (True, False), (False, True), (False, False)])
def test_each_kind_of_channel_and_of_joint_has_its_size(sliding, base, lack) -> None:
    """Accelerometers, gyroscopes, joints that turn and that slide; what the state does not hold has no size."""
    of, size = observation_of(sliding.with_gyroscopes(["s1", "s3"]), base=base, lack=lack)
    states, variance = np.zeros((4, size)), np.zeros((4, len(of.reported)))
    states[:, 3 * 2 : 3 * 2 + 15] = 100.0  # offsets are no part of it
    states[:, 1], states[:, 4] = [3.0, -3.0, 3.0, -3.0], 0.5
    variance[:, :6] = [9.0, 16.0, 9.0, 9.0, 0.0, 9.0]
    if base:
        states[:, of.base_column : of.base_column + 3] = [1.0, 2.0, -3.0]
        variance[:, 6:9] = [0.0, 2.0, 2.0]
    if lack:
        states[:, of.lack_column : of.lack_column + 15] = [2.0] * 9 + [0.3] * 6
        variance[:, -15:] = [0.0] * 8 + [9.0 * 12.0] + [0.07 * 6.0] + [0.0] * 5
    sizes = sizes_of(of, Pass(states, variance, states, states), np.array([True, False]), 0.7)
    assert sizes.lack_std == pytest.approx(4.0 if lack else 0.0)
    assert sizes.rate_lack_std == pytest.approx(0.4 if lack else 0.0)
    assert sizes.base_std == pytest.approx(np.sqrt(6.0) if base else 0.0)
    np.testing.assert_allclose(sizes.speed_std, [5.0, 0.5])
    assert sizes.memory_s == 0.7


def test_noise_of_each_kind_of_sensor_is_found_by_itself(dd_arm) -> None:
    of = observation_of(replace(dd_arm, sensors=dd_arm.sensors[:2]).with_gyroscopes([dd_arm.sensors[0].name]))[0]
    rng, one = np.random.default_rng(6), course(9, 0.01)
    noise = np.repeat([0.5, 0.5, 0.03], 3) * rng.standard_normal((N, 9))
    variance = noise_variances(of, one, found(noise, one.noise * one.doubt))
    assert variance.shape == (N, 9)
    expected = np.repeat([0.5, 0.5, 0.03], 3)
    np.testing.assert_allclose(np.sqrt(np.median(variance, axis=0)), expected, rtol=0.15)


def test_noise_is_that_of_half_a_second_before_and_after() -> None:
    """All readings of a second about an instant count as one, and four degrees of freedom pull to what all say."""
    rng, one = np.random.default_rng(8), course(std=1e-3)
    noise = (0.5 + np.arange(N) / N)[:, None] * rng.standard_normal((N, 6))
    one.present[2000:2150] = False
    variance = noise_variances(OF, one, found(noise, one.noise * one.doubt))
    s = np.square(noise).reshape(N, 2, 3).sum(axis=2) * one.present[:, None]
    local = (7.0 * variance[:, ::3] - s) / 4.0  # Student's weight undone
    np.testing.assert_allclose(local[:, 0], local[:, 1], rtol=1e-9)
    heard = (7.0 * s / (4.0 + s / local)).sum(axis=1)
    pulls = []
    for k in range(100, N - 100, 50):
        about = slice(k - 50, k + 50)
        count = 6 * np.count_nonzero(one.present[about])
        pulls.append((4.0 + count) * local[k, 0] - heard[about].sum())
    np.testing.assert_allclose(pulls, np.mean(pulls), rtol=0.02)
    assert 0.2 * 4.0 < np.mean(pulls) < 2.0 * 4.0


def test_readings_that_were_used_up_say_as_much_of_their_noise() -> None:
    """The precision of an instant says how much of the noise is left in the error: both count by their ratio."""
    rng, one = np.random.default_rng(7), course(std=0.1)._replace(doubt=np.full((N, 6), 2.5))
    noise = 0.4 * rng.standard_normal((N, 6))
    before = one.noise * one.doubt
    plain = noise_variances(OF, one, found(noise, before))
    half = Pass(np.zeros((N, 1)), np.zeros((N, 1)), np.sqrt(0.5) * noise / before, 0.5 / before * np.ones((N, 6)))
    np.testing.assert_allclose(noise_variances(OF, one, half), plain, rtol=1e-9)
    assert np.sqrt(np.median(plain)) == pytest.approx(0.4, rel=0.15)
