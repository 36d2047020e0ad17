"""A base that moves: all sensors feel a sine along the base frame's axes, each in its own."""

from dataclasses import replace

import numpy as np

from arm.accelerometer import specific_force
from arm.counts import COUNT_M_S2
from arm.effects.base_motion import EFFECT

DT = 1e-3
VALUES = {"x_m_s2": 0.5, "y_m_s2": 0.2, "z_m_s2": -0.3, "frequency_hz": 7.0}


def test_it_is_felt_as_gravity_that_sways(arm, swung, on_sensor, read):
    """To an arm that is held still it is as though gravity pointed elsewhere."""
    still = np.tile([0.3, -0.4, 0.9], (400, 1))
    motion = replace(swung(arm, 400), q=still, dq=0 * still, ddq=0 * still)
    found = read(on_sensor(arm, "base_motion", **VALUES), [motion])
    for k in (10, 100, 333):
        wave = np.sqrt(2.0) * np.sin(2 * np.pi * 7.0 * k * DT)
        gravity = np.array(arm.gravity_m_s2) - wave * np.array([0.5, 0.2, -0.3])
        swayed = specific_force(replace(arm, gravity_m_s2=tuple(gravity)), still[:1], 0 * still[:1], 0 * still[:1])
        np.testing.assert_allclose(found[k], swayed[0], rtol=0, atol=COUNT_M_S2)


def test_its_numbers_are_root_mean_squares():
    t, still = np.arange(1000) / 1000.0, np.zeros((1000, 3))
    felt = EFFECT.force(still, t, np.tile(np.eye(3), (1000, 1, 1)), VALUES)
    np.testing.assert_allclose(np.sqrt(np.mean(felt**2, axis=0)), [0.5, 0.2, 0.3], rtol=1e-12)


def test_a_sensor_feels_it_in_its_own_axes():
    """Its x is the base's y, its y the base's z, its z the base's x."""
    axes = np.array([[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    before = np.array([[1.0, 2.0, 3.0]])
    felt = EFFECT.force(before, np.array([1.0 / 28.0]), axes, VALUES)  # a quarter of a period
    np.testing.assert_allclose(felt - before, np.sqrt(2.0) * np.array([[0.2, -0.3, 0.5]]), rtol=1e-12)


def test_what_it_may_be(ranges):
    for axis in ("x_m_s2", "y_m_s2", "z_m_s2"):
        ranges("base_motion", axis, -100.0, 100.0, **{k: v for k, v in VALUES.items() if k != axis})
    ranges("base_motion", "frequency_hz", 1e-2, 1e4, x_m_s2=0.0, y_m_s2=0.0, z_m_s2=0.0)
