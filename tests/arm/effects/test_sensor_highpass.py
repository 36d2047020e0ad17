"""An AC-coupled sensor, which forgets slow motion."""

import numpy as np

from arm.effects.effect_table import changed


def test_its_own_sensor_gets_the_corner(arm, on_sensor):
    coupled = changed(on_sensor(arm, "sensor_highpass", corner_hz=0.5))
    assert [sensor.highpass_hz for sensor in coupled.sensors] == [0.0, 0.0, 0.5, 0.0, 0.0, 0.0]


def test_of_a_sudden_turn_it_forgets_all_but_a_tail(arm, on_sensor, swung, read):
    """A step passes and fades by ``exp(-2 pi f t)``."""
    motion = swung(arm)
    k = np.arange(800)[:, None]
    q = np.where(k < 100, [0.0, 0.0, 0.0], [0.0, 0.8, 0.0])
    held = type(motion)(motion.t, q, 0 * q, 0 * q, motion.tau, motion.ref)
    coupled, plain = (read(one, [held])[:, 2] for one in (on_sensor(arm, "sensor_highpass", corner_hz=0.5), arm))
    jump = plain[100] - plain[99]
    faded = np.outer(np.exp(-np.pi * (np.arange(100, 800) - 99.5) * 1e-3), jump)
    assert np.abs(jump).max() > 3.0
    np.testing.assert_allclose(coupled[100:], faded, rtol=0, atol=0.01)
    np.testing.assert_allclose(coupled[:100], 0.0, atol=0.01)


def test_it_is_none_to_a_kilohertz(ranges):
    ranges("sensor_highpass", "corner_hz", 0.0, 1e3)
