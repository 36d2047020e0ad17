"""A sensor that sits elsewhere on its link than was said."""

from dataclasses import replace

import numpy as np

from arm.counts import COUNT_M_S2
from arm.effects.effect_table import changed

OFF = {"x_m": 0.02, "y_m": -0.01, "z_m": 0.03}


def test_its_own_sensor_is_moved_along_the_links_axes(arm, on_sensor):
    moved = changed(on_sensor(arm, "mounting_radius", **OFF))
    assert moved.sensors[:2] + moved.sensors[3:] == arm.sensors[:2] + arm.sensors[3:]
    np.testing.assert_allclose(
        moved.sensors[2].position_m, np.array(arm.sensors[2].position_m) + [0.02, -0.01, 0.03]
    )


def test_it_reads_what_a_sensor_at_that_place_would(arm, on_sensor, swung, read):
    x, y, z = arm.sensors[2].position_m
    there = replace(arm.sensors[2], position_m=(x + 0.02, y - 0.01, z + 0.03))
    same = replace(arm, sensors=(*arm.sensors[:2], there, *arm.sensors[3:]))
    motion = swung(arm)
    found, expected = (read(one, [motion]) for one in (on_sensor(arm, "mounting_radius", **OFF), same))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1.01 * COUNT_M_S2)


def test_what_it_may_be(ranges):
    for axis in OFF:
        ranges("mounting_radius", axis, -10.0, 10.0, **{name: 0.0 for name in OFF if name != axis})
