"""Where a motor is in its play."""

import numpy as np

from fitter.diagnosis.in_transmission import side


def test_a_motor_touches_the_side_towards_which_it_pulls():
    torque = np.array([1.0, 0.8, 0.02, -0.02, 0.01, -0.9, -1.0, -1.0])
    where = side(torque, 0.1)
    np.testing.assert_array_equal(where[:2], 1.0)
    np.testing.assert_array_equal(where[5:], -1.0)
    assert np.all(np.diff(where[1:6]) < 0.0)


def test_noise_about_zero_does_not_cross_the_play():
    rng = np.random.default_rng(0)
    torque = np.concatenate([np.ones(20), 0.01 * rng.normal(size=200), np.ones(20)])
    np.testing.assert_array_equal(side(torque, 0.1), 1.0)


def test_nobody_can_tell_without_torque():
    np.testing.assert_array_equal(side(np.zeros(5), 0.1), 0.0)
