"""Sizes of what the model lacks, put into a course."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from arm.arm_file import load_arm
from tracking.model.course import course_of
from tracking.model.discrepancy import Discrepancy, speed_rate, with_sizes
from tracking.model.noise import Noise
from tracking.model.observation import observation_of
from tracking.model.readings import Readings

ARM = load_arm("dd-arm")
TWO_AND_A_GYROSCOPE = replace(ARM, sensors=ARM.sensors[:2]).with_gyroscopes([ARM.sensors[1].name])


@pytest.mark.parametrize(("std", "counts_as"), [(0.7, 0.7), (0.02, 0.02), (0.01, 0.02), (0.0, 0.02)])
def test_the_rate_gives_the_speed_its_standard_deviation(std: float, counts_as: float) -> None:
    """No less than 0.02 rad/s: a joint that never moved has no speed to learn."""
    push = 2500.0
    rate = float(speed_rate(np.array([push]), np.array([std]))[0])
    A = np.array([[0.0, 1.0], [-(rate**2), -2.0 * rate]])
    stationary = solve_continuous_lyapunov(A, -np.diag([0.0, push]))
    assert np.sqrt(stationary[0, 0]) == pytest.approx(counts_as)


def test_each_kind_of_channel_has_its_own_size() -> None:
    of, _ = observation_of(TWO_AND_A_GYROSCOPE)
    sizes = Discrepancy(0.3, 0.0, 0.1, np.ones(2), 0.02)
    np.testing.assert_array_equal(sizes.lack_stds(of), [0.3] * 6 + [0.02] * 3)
    np.testing.assert_array_equal(Discrepancy(0.3, 0.0, 0.1, np.ones(2)).lack_stds(of), [0.3] * 6 + [0.0] * 3)


def test_a_course_takes_over_sizes_and_variances() -> None:
    of, _ = observation_of(TWO_AND_A_GYROSCOPE)
    noise = Noise(np.linspace(0.01, 0.09, 9), np.zeros(9))
    before = course_of(Readings(np.zeros((5, 9)), 0.01, 0.0, noise, 1), 2)
    variance = np.linspace(0.1, 0.5, 45).reshape(5, 9)
    speed_std = np.array([1.0, 0.5])
    one = with_sizes(of, before, Discrepancy(0.2, 0.3, 0.05, speed_std, 0.04), variance)
    np.testing.assert_allclose(one.noise * one.doubt, variance)
    assert (one.lack_std.tolist(), one.base_std, one.memory_s) == ([0.2] * 6 + [0.04] * 3, 0.3, 0.05)
    np.testing.assert_allclose(before.push / (4.0 * one.rate**3), speed_std**2)
    np.testing.assert_array_equal(one.readings, before.readings)
