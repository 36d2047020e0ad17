"""What an arm file as a whole does not allow."""

import pytest

from arm.schema_contradictions import contradictions

JOINTS = [{}, {}]


def test_channels_of_a_gyroscope_are_no_other_sensor_s():
    sensors = [{"name": "s1", "joint": 1, "gyroscope": {}}, {"name": "s1g", "joint": 2}]
    (found,) = contradictions({"joint": JOINTS, "sensor": sensors}, "it")
    assert found.startswith(
        "it: sensor[1].name is 's1g': so are the channels of the gyroscope of sensor[0] called"
    )
    del sensors[0]["gyroscope"]
    assert contradictions({"joint": JOINTS, "sensor": sensors}, "it") == []


@pytest.mark.parametrize("law", ["pid", "p", "measured"])
def test_gains_are_one_a_joint_whatever_the_law(law):
    control = {"law": law, "kp": [1.0, 1.0], "kv": [1.0]}
    assert contradictions({"joint": JOINTS, "control": control}, "it") == [
        "it: control.kv has 1 numbers, expected one a joint (2)"
    ]


def test_gains_that_the_law_needs_must_be_there():
    found = contradictions({"joint": JOINTS, "control": {"law": "pda", "kp": [1.0, 1.0]}}, "it")
    assert found == [f"it: control.{name} has 0 numbers, expected one a joint (2)" for name in ("kv", "ka")]


def test_what_has_the_wrong_type_is_passed_over():
    assert contradictions({"joint": 3, "sensor": [7], "control": {"law": "pd", "kp": "x"}}, "it") == []
