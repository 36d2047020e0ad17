"""An accelerometer's axis that reads too much or too little."""

import numpy as np

from arm.counts import COUNT_M_S2
from arm.effects.effect_table import changed


def test_each_axis_is_multiplied_by_its_own_factor(arm, on_sensor, swung, read):
    motion = swung(arm)
    scaled, plain = (read(one, [motion]) for one in (on_sensor(arm, "sensor_scale", x=1.1, y=0.9, z=1.2), arm))
    np.testing.assert_allclose(scaled[:, 2], plain[:, 2] * [1.1, 0.9, 1.2], rtol=0, atol=1.2 * COUNT_M_S2)
    np.testing.assert_array_equal(np.delete(scaled, 2, axis=1), np.delete(plain, 2, axis=1))


def test_it_multiplies_a_scale_that_is_there(arm, on_sensor):
    once = changed(on_sensor(arm, "sensor_scale", x=1.1, y=0.9, z=1.2))
    twice = changed(on_sensor(once, "sensor_scale", x=2.0, y=3.0, z=0.5))
    np.testing.assert_allclose(twice.sensors[2].scale, [2.2, 2.7, 0.6])


def test_no_axis_reads_nothing(ranges):
    for axis in "xyz":
        ranges("sensor_scale", axis, 1e-3, 100.0, **{other: 1.0 for other in "xyz" if other != axis})
