"""An accelerometer's zero that is off."""

import numpy as np

from arm.counts import COUNT_M_S2
from arm.effects.effect_table import changed

OFF = {"x_m_s2": 0.5, "y_m_s2": -0.2, "z_m_s2": 0.1}


def test_its_own_sensor_reads_so_much_more(arm, on_sensor, swung, read):
    motion = swung(arm)
    more = read(on_sensor(arm, "sensor_bias", **OFF), [motion]) - read(arm, [motion])
    expected = np.zeros((6, 3))
    expected[2] = [0.5, -0.2, 0.1]
    np.testing.assert_allclose(more, np.broadcast_to(expected, more.shape), rtol=0, atol=1.01 * COUNT_M_S2)


def test_it_adds_to_a_bias_that_is_there(arm, on_sensor):
    once = on_sensor(arm, "sensor_bias", **OFF)
    twice = on_sensor(changed(once), "sensor_bias", **OFF)
    np.testing.assert_allclose(changed(twice).sensors[2].bias_m_s2, [1.0, -0.4, 0.2])


def test_what_it_may_be(ranges):
    for axis in OFF:
        ranges("sensor_bias", axis, -100.0, 100.0, **{name: 0.0 for name in OFF if name != axis})
