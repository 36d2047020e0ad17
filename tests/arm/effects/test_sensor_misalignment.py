"""A sensor that is mounted turned."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from arm.counts import COUNT_M_S2
from arm.effects.effect_table import changed

TURNED = {"roll_rad": 0.2, "pitch_rad": -0.3, "yaw_rad": 0.5}


def test_it_reads_the_same_force_in_turned_axes(arm, on_sensor, swung, read):
    """By scipy's composition of roll, pitch and yaw about fixed axes."""
    straight = replace(arm, sensors=tuple(replace(s, rotation_rad=(0.0, 0.0, 0.0)) for s in arm.sensors))
    motion = swung(arm)
    found, plain = (
        read(one, [motion]) for one in (on_sensor(straight, "sensor_misalignment", **TURNED), straight)
    )
    R = Rotation.from_euler("xyz", [0.2, -0.3, 0.5]).as_matrix()
    np.testing.assert_allclose(found[:, 2] @ R.T, plain[:, 2], rtol=0, atol=2.0 * COUNT_M_S2)
    np.testing.assert_array_equal(np.delete(found, 2, axis=1), np.delete(plain, 2, axis=1))


def test_it_adds_to_the_files_own_angles(arm, on_sensor):
    turned = changed(on_sensor(arm, "sensor_misalignment", **TURNED)).sensors
    np.testing.assert_allclose(turned[2].rotation_rad, [0.5, -0.3, 0.5])
    assert turned[:2] + turned[3:] == arm.sensors[:2] + arm.sensors[3:]


def test_it_is_half_a_turn_at_most(ranges):
    for angle in TURNED:
        ranges("sensor_misalignment", angle, -3.2, 3.2, **{name: 0.0 for name in TURNED if name != angle})
