"""A sensor whose samples come late."""

import numpy as np
import pytest

from arm.effects.time_skew import Skew


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 3.7, 12.5])
def test_late_readings_are_those_of_some_time_ago(delay):
    wave = lambda k: np.column_stack([np.sin(0.1 * k), np.cos(0.07 * k)])  # noqa: E731
    skew = Skew(delay)
    k = np.arange(300.0)
    late = np.vstack([skew.apply(part) for part in np.split(wave(k), [7, 8, 150])])
    np.testing.assert_allclose(late[20:], wave(k - delay)[20:], rtol=0, atol=1e-4)
    assert np.all(late[0] == pytest.approx(wave(k)[0]))


@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0, 1.6, 5.25])
def test_cubics_are_followed_exactly(delay):
    cubic = np.polynomial.Polynomial([1.0, -0.2, 0.03, -0.001])
    k = np.arange(40.0)
    late = Skew(delay).apply(cubic(k)[:, None])[:, 0]
    np.testing.assert_allclose(late[9:], cubic(k - delay)[9:], rtol=0, atol=1e-11)


def test_before_its_first_sample_the_sensor_rested():
    late = Skew(4.0).apply(np.array([[2.0], [3.0], [5.0], [7.0], [11.0], [13.0]]))
    np.testing.assert_allclose(late[:, 0], [2.0, 2.0, 2.0, 2.0, 2.0, 3.0], rtol=1e-12)


def test_a_block_without_samples_changes_nothing():
    skew, k = Skew(2.0), np.arange(6.0)[:, None]
    assert skew.apply(k[:0]).shape == (0, 1)
    first = skew.apply(k[:3])
    assert skew.apply(k[:0]).shape == (0, 1)
    np.testing.assert_allclose(np.vstack([first, skew.apply(k[3:])])[2:, 0], [0.0, 1.0, 2.0, 3.0], atol=1e-12)


def test_a_delay_is_none_to_a_second(ranges):
    ranges("time_skew", "delay_s", 0.0, 1.0)
