"""The schema of arm files: every mistake is a sentence that names its field."""

import pytest

from arm.arm_file import format_arm, parse_arm
from arm.arm_schema import ArmTable
from arm.model import Arm, Base, Body, Effect, Gyroscope, Joint, Marker, Sensor, SensorCovariance, Tip
from arm.schema_contradictions import contradictions
from limbcal.errors import ConfigError
from tests.arm.every_table import EFFECT, EVERYTHING


def mistakes(text, where="arm.toml"):
    with pytest.raises(ConfigError) as caught:
        parse_arm(text, where)
    assert caught.value.exit_code == 2
    return caught.value.mistakes


def test_three_mistakes_are_three_sentences_that_name_their_fields():
    text = EVERYTHING.replace("a_m = 0.25", 'a_m = "long"').replace("\nd_m = 0.0", "\ndm = 0.0")
    text = text.replace('law = "pd"', 'law = "pid"')
    found = mistakes(text)
    assert len(found) == 3
    assert found[0].startswith("arm.toml: joint[0].a_m is 'long'; input should be a valid number")
    assert found[1] == "arm.toml: joint[0].dm is not a known field; did you mean 'd_m'?"
    assert found[2].startswith("arm.toml: control.law is 'pid'; input should be 'pd', 'pda', 'p' or 'measured'")


def test_mistakes_in_a_field_do_not_hide_those_between_fields():
    text = EVERYTHING.replace("a_m = 0.25", "a_m = true").replace('sensor = "s4"', 'sensor = "s9"')
    text = text.replace("kp = [9.5, 9.5]", "kp = [9.5]").replace("joint = 2", "joint = 3")
    text = text.replace('name = "s4"', 'name = "s1"')
    found = mistakes(text)
    assert found[0].startswith("arm.toml: joint[0].a_m is True;")
    assert set(found[1:]) == {
        "arm.toml: sensor[1].joint is 3, expected 1 to 2",
        "arm.toml: marker[0].joint is 3, expected 0 to 2",
        "arm.toml: sensor[1].name is 's1', which sensor[0] has already",
        "arm.toml: tip.sensor is 's9', expected one of s1, s1",
        "arm.toml: control.kp has 1 numbers, expected one a joint (2)",
    }


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("schema = 1", "schema = 2"), "it: schema is 2; input should be 1"),
        (("schema = 1\n", ""), "it: schema is missing"),
        (("schema = 1", "schema = true"), "it: schema is True; input should be 1"),
        (("std = 0.0004", "std = -2"), "it: base_parameters.I1+m2*L1^2.std is -2; expected a finite number not"),
        (("std = 0.0004", "std = inf"), "it: base_parameters.I1+m2*L1^2.std is inf; expected a finite number"),
        (('"human-arm-right"', '"dog"'), "it: body.preset is 'dog'; expected one of human-arm-right, human-arm-"),
        (("scapula_right", "tail"), "it: base.segment is 'tail'; expected one of pelvis, thorax, scapula_right"),
        (("scapula_right", "scapula_rigth"), "it: base.segment is 'scapula_rigth'; expected one of pelvis,"),
        (("mass_kg = 1.0", "mass_kg = nan"), "it: joint[0].link.mass_kg is nan; input should be a finite number"),
        (("a_m = 0.25", 'a_m = "0.25"'), "it: joint[0].a_m is '0.25'; input should be a valid number"),
        (("-9.80665]", "-9.80665, 1.0]"), "it: gravity_m_s2 is [0.0, 0.0, -9.80665, 1.0]; tuple should have at"),
        (("0.0, -9.80665]", "-9.8]"), "it: gravity_m_s2[2] is missing"),
        (('type = "revolute"', 'type = "ball"'), "it: joint[0].type is 'ball'; input should be 'revolute' or"),
        (('name = "s1"', 'name = ""'), "it: sensor[0].name is ''; string should have at least 1 character"),
        (("joint = 1 ", "joint = 0 "), "it: sensor[0].joint is 0; input should be greater than or equal to 1"),
        (("scale = [1.002, ", "scale = [0.0, "), "it: sensor[0].scale[0] is 0.0; input should be greater than 0"),
        (("0.998, 1.0]", "0.998, -1.0]"), "it: sensor[0].scale[2] is -1.0; input should be greater than 0"),
        (("[1.002, 0.998, 1.0]", "1.002"), "it: sensor[0].scale is 1.002; input should be a valid tuple"),
        (("highpass_hz = 0.1", "highpass_hz = -0.1"), "it: sensor[0].highpass_hz is -0.1; input should be"),
        (("highpass_hz = 0.1", "highpass_hz = inf"), "it: sensor[0].highpass_hz is inf; input should be a finite"),
        (("bias_m_s2 = [0.01, ", "bias_m_s2 = ["), "it: sensor[0].bias_m_s2[2] is missing"),
        (("std_m = 0.0005", "std_m = -0.0005"), "it: joint[0].length_std_m is -0.0005; input should be greater"),
        (("std_m = 0.0005", "std_m = nan"), "it: joint[0].length_std_m is nan; input should be a finite number"),
        (("[control]", "[controls]"), "it: controls is not a known field"),
        (("kv = [-9.5, -9.5]", ""), "it: control.kv has 0 numbers, expected one a joint (2)"),
        (("kv = [-9.5, -9.5]", "kv = -9.5"), "it: control.kv is -9.5; input should be a valid tuple"),
        (("friction = { v", "friction = 3 # {"), "it: joint[0].friction is 3; input should be a table"),
        (('sensor = "s4"', 'sensor = "s1"'), "it: tip.sensor is 's1' on link 1, expected one on link 2: the tip"),
        (('sensor = "s4"', "sensor = 4"), "it: tip.sensor is 4; input should be a valid string"),
    ],
)
def test_a_mistake_is_a_sentence(change, sentence):
    assert change[0] in EVERYTHING
    (found,) = mistakes(EVERYTHING.replace(*change, 1), "it")
    assert found.startswith(sentence)


def test_an_arm_without_joints_is_none():
    assert mistakes('schema = 1\nname = "x"\n') == ["arm.toml: joint is missing"]
    assert mistakes('schema = 1\nname = "x"\njoint = []\nsensor = 3\n')[0].startswith("arm.toml: joint is []")
    assert mistakes('schema = 1\nname = "x"\njoint = "none"\n')[0].startswith("arm.toml: joint is 'none'")


def test_a_sensor_needs_a_tip_to_be_there():
    text = 'schema = 1\nname = "x"\n[[joint]]\n[tip]\nsensor = "s1"\n'
    assert mistakes(text) == ["arm.toml: tip.sensor is 's1', expected one of no sensor"]


def test_limits_the_wrong_way_round_are_named(dd_arm) -> None:
    text = format_arm(dd_arm).replace("[[joint]]", "[[joint]]\nlimits = [1.0, -1]", 1)
    with pytest.raises(ConfigError, match=r"joint\[0\].limits is \[1.0, -1\], expected the least one first"):
        parse_arm(text, "arm.toml")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("../../out", "expected no / and no"),
        ("/etc/passwd", "expected no / and no"),
        ("..\\\\out", "expected no / and no"),
        (".hidden", "expected no dot at its beginning"),
        ("\\u001b[2J", "is '\\x1b[2J'; expected only characters that can be printed"),
        ("\\n<0>panic", "is '\\n<0>panic'; expected only characters that can be printed"),
        ("\\u0000", "a NUL character"),
        ("", "at least 1 character"),
        ("x" * 65, "at most 64 characters"),
    ],
)
def test_a_name_cannot_lead_out_of_a_folder(name, said):
    with pytest.raises(ConfigError) as caught:
        parse_arm(f'schema = 1\nname = "{name}"\n[[joint]]\na_m = 1.0\n', "arm.toml")
    assert said in str(caught.value) and str(caught.value).isprintable()
    if not name.startswith("."):  # a sensor's name becomes no beginning of a file's
        with pytest.raises(ConfigError, match="."):
            parse_arm(
                f'schema = 1\nname = "a"\n[[joint]]\na_m = 1.0\n[[sensor]]\nname = "{name}"\njoint = 1\n', "x"
            )


def test_an_effects_mistakes_are_those_of_the_file():
    wrong = '[[effect]]\nname = "backlash"\njoints = [3, "1"]\nparameters = { gap_rad = -0.1 }\n'
    assert EFFECT in EVERYTHING
    assert mistakes(EVERYTHING.replace(EFFECT, wrong), "it") == [
        "it: effect[0].joints[1] is '1'; input should be a valid integer",
        "it: effect[0].joints has 3, expected 1 to 2",
        "it: effect[0].parameters.gap_rad is -0.1, expected a number from 0 to 1",
    ]


def test_what_has_the_wrong_type_contradicts_nothing():
    raw = {
        "joint": [3, {"parent": True, "limits": ["a", 1]}],
        "sensor": "s1",
        "tip": 4,
        "control": 5,
        "effect": {},
    }
    assert contradictions(raw, "it") == []
    assert contradictions({"sensor": [{"name": 3, "joint": "2"}, {"name": 3}], "tip": {"sensor": 7}}, "it") == []


def test_without_joints_nothing_rides_too_far_out():
    raw = {"sensor": [{"name": "a", "joint": 4}], "control": {"law": "pd"}}
    assert contradictions(raw, "it") == []
    assert contradictions({**raw, "joint": [{}] * 4, "control": {}}, "it") == []
    assert contradictions({**raw, "joint": [{}] * 3, "control": {}}, "it") == [
        "it: sensor[0].joint is 4, expected 1 to 3"
    ]


@pytest.mark.parametrize(
    ("law", "needed"), [("pd", {"kp", "kv"}), ("pda", {"kp", "kv", "ka"}), ("p", {"kp"}), ("measured", set())]
)
def test_each_law_needs_its_own_gains(law, needed):
    said = contradictions({"joint": [{}], "control": {"law": law}}, "it")
    assert said == [
        f"it: control.{gain} has 0 numbers, expected one a joint (1)"
        for gain in ("kp", "kv", "ka")
        if gain in needed
    ]


def test_limits_that_are_equal_leave_no_range():
    assert contradictions({"joint": [{"limits": [1, 1]}]}, "it") == [
        "it: joint[0].limits is [1, 1], expected the least one first"
    ]


def test_two_of_a_name_are_told_apart():
    raw = {
        "joint": [{}],
        "marker": [{"name": "A", "joint": 1}, {"name": "B", "joint": 0}, {"name": "A", "joint": 2}],
    }
    assert contradictions(raw, "it") == [
        "it: marker[2].joint is 2, expected 0 to 1",
        "it: marker[2].name is 'A', which marker[0] has already",
    ]


def test_what_is_left_out_is_what_the_model_has():
    raw = {
        "schema": 1,
        "name": "x",
        "joint": [{"friction": {}, "link": {}}],
        "sensor": [{"name": "s1", "joint": 1, "gyroscope": {}}],
        "tip": {"sensor": "s1"},
        "base": {},
        "marker": [{"name": "A", "joint": 0}],
        "effect": [{"name": "label_swap"}],
        "control": {},
    }
    assert ArmTable.model_validate(raw).arm() == Arm(
        "x",
        (Joint(),),
        sensors=(Sensor("s1", 1, gyroscope=Gyroscope()),),
        tip=Tip("s1"),
        base=Base(),
        markers=(Marker("A", 0),),
        effects=(Effect("label_swap"),),
    )


def test_rarer_tables_become_parts_of_the_arm():
    raw = {
        "schema": 1,
        "name": "x",
        "joint": [{"link": {"air_drag_N_m_s2": 0.5}}],
        "sensor": [{"name": "s1", "joint": 1, "gyroscope": {"bias_rad_s": [0.1, 0.2, 0.3]}}],
        "sensor_covariance": {"parameters": ["s1 bias_x"], "covariance": [[0.04]]},
        "base": {"segment": "pelvis"},
        "marker": [{"name": "A", "joint": 0, "landmark": "c7"}],
        "body": {"preset": "human-body", "mass_kg": 70, "height_m": 1.75, "sex": "f"},
    }
    arm = ArmTable.model_validate(raw).arm()
    assert arm.joints[0].link.air_drag_N_m_s2 == 0.5
    assert arm.sensors == (Sensor("s1", 1, gyroscope=Gyroscope(bias_rad_s=(0.1, 0.2, 0.3))),)
    assert arm.sensor_covariance == SensorCovariance(("s1 bias_x",), ((0.04,),))
    assert (arm.base, arm.markers) == (Base(segment="pelvis"), (Marker("A", 0, landmark="c7"),))
    assert arm.body == Body("human-body", 70.0, 1.75, "f")
