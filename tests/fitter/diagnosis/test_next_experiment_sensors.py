"""What a finding of the sensors says to do next."""

import pytest

from fitter.diagnosis.next_experiment import next_for_sensors


def test_a_cause_is_to_be_put_right_where_it_is():
    said = next_for_sensors("named", (), [("sensor_bias", "s2")], ())
    assert "sensor_bias of s2" in said


@pytest.mark.parametrize(
    ("pair", "word"),
    [
        (("sensor_bias", "sensor_scale"), "gravity"),
        (("sensor_drift", "sensor_highpass"), "rest for some minutes"),
        (("mounting_radius", "sensor_misalignment"), "turn it fast"),
        (("base_motion", "time_skew"), "every joint by itself"),
    ],
)
def test_equals_are_told_apart_by_what_they_differ_in(pair, word):
    assert word in next_for_sensors("ambiguous", (pair,), [], ())


def test_what_is_unexplained_is_to_be_varied_by_what_it_depends_on():
    assert "q2" in next_for_sensors("unexplained", (), [], ("q2",))
    assert "several times" in next_for_sensors("unexplained", (), [], ())
    assert next_for_sensors("none", (), [], ()).startswith("none is needed")
