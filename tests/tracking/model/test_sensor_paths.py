"""Where sensors go, by dead reckoning from exact readings and angles."""

from dataclasses import replace

import numpy as np
import pytest

from arm.kinematics import sensor_positions
from tracking.model.sensor_paths import SensorPaths

RATE_HZ = 1000.0
TRAVEL = {"dd_arm": (0.9, -0.6), "spatial": (0.8, -0.7, 0.5), "sliding": (0.7, 0.15)}


def moved(recording, still=None, cuts=(), gain=1.0, arm=None):
    """Return the displacement of every sensor as the tracker would ask for it, in pieces."""
    paths = SensorPaths(arm or recording.arm, 1.0 / recording.rate_hz)
    held = np.zeros(len(recording.q), dtype=bool) if still is None else still
    parts = zip(*(np.split(whole, cuts) for whole in (recording.q, gain * recording.readings, held)), strict=True)
    return np.vstack([paths.follow(*part) for part in parts])


def truly(recording):
    places = sensor_positions(recording.arm, recording.q)
    return places - places[0]


@pytest.mark.parametrize("name", list(TRAVEL))
def test_exact_readings_show_where_sensors_went(request, glided, name):
    """To a tenth of a millimetre over a motion of half a metre, whatever the arm and its sensors' axes."""
    recording = glided(request.getfixturevalue(name), RATE_HZ, TRAVEL[name])
    expected = truly(recording)
    assert np.abs(expected[-1]).max() > 0.1
    np.testing.assert_allclose(moved(recording), expected, rtol=0, atol=1e-4)


def test_no_length_and_no_place_is_used(spatial, glided):
    """Another arm's lengths and places give the same bytes."""
    recording = glided(spatial, RATE_HZ, TRAVEL["spatial"])
    longer = replace(
        spatial,
        joints=tuple(replace(joint, a_m=joint.a_m + 0.3, d_m=1.0) for joint in spatial.joints),
        sensors=tuple(replace(sensor, position_m=(9.0, 9.0, 9.0)) for sensor in spatial.sensors),
    )
    assert moved(recording, arm=longer).tobytes() == moved(recording).tobytes()


def test_pieces_of_any_size_give_the_same(dd_arm, glided):
    recording = glided(dd_arm, RATE_HZ, TRAVEL["dd_arm"])
    np.testing.assert_array_equal(moved(recording, cuts=(1, 7, 400, 900, 901)), moved(recording))


def test_a_sensors_scale_is_taken_out(dd_arm, glided):
    recording = glided(dd_arm, RATE_HZ, TRAVEL["dd_arm"])
    coarse = replace(dd_arm, sensors=tuple(replace(s, scale=(1.25, 1.25, 1.25)) for s in dd_arm.sensors))
    np.testing.assert_allclose(moved(recording, gain=1.25, arm=coarse), truly(recording), rtol=0, atol=1e-4)


def test_a_rest_ends_what_an_offset_makes_of_a_speed(dd_arm, glided):
    recording = glided(dd_arm, RATE_HZ, (0.0, 0.0))
    recording = replace(recording, readings=recording.readings + 0.1)
    still = np.zeros(len(recording.q), dtype=bool)
    still[500:] = True
    found = moved(recording, still)
    assert np.abs(found[499]).min() > 0.01
    np.testing.assert_array_equal(found[500:], np.broadcast_to(found[499], found[500:].shape))
    assert np.abs(found[499] - 0.5 * 0.1 * 0.5**2).max() < 1e-3


def test_while_readings_are_lost_a_sensor_goes_on_as_fast_as_it_went(dd_arm, glided):
    """Ten lost frames of a motion at some 0.5 m/s: it goes on, and not a number comes out."""
    recording = glided(dd_arm, RATE_HZ, TRAVEL["dd_arm"])
    readings = recording.readings.copy()
    readings[1200:1210] = np.nan
    found = moved(replace(recording, readings=readings))
    assert np.isfinite(found).all()
    assert np.abs(found[1210] - found[1199]).max() > 2e-3
    assert np.abs(found[1210] - truly(recording)[1210]).max() < 1e-3
