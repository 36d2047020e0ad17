"""What a finding says to do next."""

import pytest

from fitter.diagnosis.readings.remaining import Remaining
from fitter.diagnosis.readings.sensor_verdict import SensorCause, next_experiment

NOISE, ANGLE = Remaining(0.0, True, ()), Remaining(0.4, False, ("q2", "t"))


def test_a_cause_is_to_be_put_right_where_it_is():
    said = next_experiment("named", (), [SensorCause("sensor_bias", ("s2",), {}, 1.0)], NOISE)
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
    assert word in next_experiment("ambiguous", (pair,), [], NOISE)


def test_what_is_unexplained_is_to_be_varied_by_what_it_depends_on():
    assert "q2" in next_experiment("unexplained", (), [], ANGLE)
    assert "several times" in next_experiment("unexplained", (), [], Remaining(0.0, False, ()))
    assert next_experiment("none", (), [], NOISE).startswith("none is needed")
