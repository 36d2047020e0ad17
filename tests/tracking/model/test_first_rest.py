"""How fast an arm may be when a recording begins, by how much its first readings change."""

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.model import Arm
from tracking.model.first_rest import MOVING_STDS, RESTING_STDS, FirstReadings, begin_stds, first_readings, resting
from tracking.model.noise import Noise

RATE_HZ, NOISE, WINDOW_S = 100.0, 0.01, 0.25
Q = np.array([0.4, -0.3])
#: Of two angles, a radian of which changes what is read by gravity.
SEEN = 9.8 * np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])


def first_of(values: np.ndarray) -> FirstReadings:
    noise = Noise(np.full(values.shape[1], NOISE**2), np.zeros(values.shape[1]))
    return first_readings(values, 1.0 / RATE_HZ, noise, 1)


def noisy(values: np.ndarray) -> np.ndarray:
    return values + NOISE * np.random.default_rng(0).standard_normal(values.shape)


def test_readings_that_stay_are_of_an_arm_at_rest() -> None:
    first = first_of(noisy(np.tile([1.0, 2.0, 3.0], (30, 1))))
    assert first.steady
    np.testing.assert_allclose(first.mean, [1.0, 2.0, 3.0], atol=0.01)
    for found, std in zip(begin_stds(first, SEEN), RESTING_STDS, strict=True):
        assert found.tolist() == [std] * 2


def test_a_change_is_the_largest_between_any_two_instants() -> None:
    values = np.zeros((40, 3))
    values[5:9, 1], values[20, 1], values[30, 1] = (
        0.5,
        -0.3,
        9.0,
    )  # what comes after a quarter of a second is not asked
    assert first_of(values).change.tolist() == pytest.approx([0.0, 0.8, 0.0])


def test_where_readings_are_lost_nothing_is_known() -> None:
    values = np.ones((40, 3))
    values[3] = np.nan
    for lost in (values, np.ones((10, 3))):
        first = first_of(lost)
        assert np.isinf(first.change).all() and first.mean.tolist() == [1.0] * 3
        for found, std in zip(begin_stds(first, SEEN), MOVING_STDS, strict=True):
            assert found.tolist() == [std] * 2


def test_a_joint_is_as_fast_as_what_it_would_change() -> None:
    """A uniform bound: 0.01 rad in a quarter of a second hide 0.16 rad/s and 1.28 rad/s^2."""
    slope = SEEN.copy()
    slope[1, 1] = 0.0  # gravity does not show the second angle
    speed, acceleration = begin_stds(FirstReadings(np.zeros(3), np.array([0.098, 0.0, 7.0])), slope)
    np.testing.assert_allclose(speed, [0.16 / np.sqrt(3.0), 5.0], rtol=1e-3)
    np.testing.assert_allclose(acceleration, [1.28 / np.sqrt(3.0), 10.0], rtol=3e-3)


def test_a_change_as_small_as_noise_leaves_a_rest() -> None:
    speed, acceleration = begin_stds(FirstReadings(np.zeros(3), np.full(3, 1e-6)), SEEN)
    assert speed.tolist() == [RESTING_STDS[0]] * 2 and acceleration.tolist() == [RESTING_STDS[1]] * 2


@pytest.mark.parametrize("seed", range(5))
def test_speeds_and_accelerations_are_within_three_of_what_is_said(seed: int) -> None:
    """Of an upright arm with two sensors a link, at any moment of a swing."""
    arm: Arm = load_arm("dd-arm-vertical")
    rng, t = np.random.default_rng(seed), np.arange(0.0, WINDOW_S, 1.0 / RATE_HZ)[:, None]
    rate, size, phase = 2.0 * np.pi * rng.uniform(0.2, 1.0, 2), rng.uniform(0.05, 0.6, 2), rng.uniform(0.0, 6.3, 2)
    q, dq = Q + size * np.sin(rate * t + phase), size * rate * np.cos(rate * t + phase)
    ddq = -size * rate**2 * np.sin(rate * t + phase)
    first = first_of(noisy(specific_force(arm, q, dq, ddq).reshape(len(t), -1)))
    step, still = 1e-6, np.zeros((1, 2))

    def read(at: np.ndarray) -> np.ndarray:
        return specific_force(arm, at[None], still, still).ravel()

    slope = np.column_stack([(read(Q + h) - read(Q - h)) / (2.0 * step) for h in step * np.eye(2)])
    speed, acceleration = begin_stds(first, slope)
    assert (np.abs(dq[0]) < 3.0 * speed).all() and (np.abs(ddq[0]) < 3.0 * acceleration).all()


def test_resting_readings_do_not_change() -> None:
    assert resting(np.ones(4)).steady and resting(np.ones(4)).mean.tolist() == [1.0] * 4
