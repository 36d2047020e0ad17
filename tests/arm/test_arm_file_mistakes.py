"""Mistakes in an arm file: every one is a sentence that names its field."""

import math

import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.model import Effect
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


def test_what_is_no_toml_is_told_with_its_line():
    (found,) = mistakes('schema = 1\nname = "x"\ngravity = [0.0,, 1.0]\n')
    assert found.startswith("arm.toml: not TOML: ") and "line 3" in found


def test_a_file_that_is_not_there_is_named_with_the_arms_that_are(tmp_path):
    with pytest.raises(ConfigError) as caught:
        load_arm(tmp_path / "no.toml")
    assert str(caught.value) == (
        f"arm '{tmp_path}/no.toml': No such file or directory; expected an arm file or one of "
        "dd-arm, dd-arm-vertical, human-arm-left, human-arm-right, human-body, human-leg-left, "
        "human-leg-right, spatial-arm"
    )
    with pytest.raises(ConfigError, match="Is a directory"):
        load_arm(tmp_path)
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(ConfigError, match="expected UTF-8 text"):
        load_arm(tmp_path / "bytes.toml")


@pytest.mark.parametrize(
    ("effect", "sentence"),
    [
        ('name = "magic"', "effect[0].name is 'magic', expected one of actuator_delay, actuator_lag, air_drag"),
        ("name = 3", "effect[0].name is 3; input should be a valid string"),
        ('name = "viscous"\njoints = [3]\nparameters = { viscous_N_m_s = 0.1 }', "joints has 3, expected 1 to 2"),
        (
            'name = "viscous"\nparameters = { viscous_N_m_s = 0.1 }',
            "effect[0].joints is missing: viscous acts on joints",
        ),
        ('name = "viscous"\njoints = [1]', "effect[0].parameters.viscous_N_m_s is missing"),
        (
            'name = "viscous"\njoints = [1]\nparameters = { viscous_N_m_s = true }',
            "is True, expected a number from -1000",
        ),
        (
            'name = "viscous"\njoints = ["1"]\nparameters = { viscous_N_m_s = 1 }',
            "joints[0] is '1'; input should be",
        ),
        (
            'name = "backlash"\njoints = [1]\nparameters = { gap_rad = -0.1 }',
            "gap_rad is -0.1, expected a number from 0 to",
        ),
        (
            'name = "backlash"\njoints = [1]\nparameters = { gap_m = 0.1, gap_rad = 0.1 }',
            "gap_m is not known, expected gap_r",
        ),
        (
            'name = "time_skew"\nsensors = ["s9"]\nparameters = { delay_s = 0.1 }',
            "has 's9', expected one of s1, s4",
        ),
        (
            'name = "time_skew"\nparameters = { delay_s = 0.1 }',
            "effect[0].sensors is missing: time_skew acts on sensors",
        ),
        (
            'name = "time_skew"\njoints = [1]\nsensors = ["s1"]\nparameters = { delay_s = 0.1 }',
            "effect[0].joints is [1], but time_skew acts on sensors",
        ),
        (
            'name = "payload"\njoints = [2]\nparameters = { mass_kg = 0.1 }',
            "but payload acts on the arm as a whole",
        ),
        (
            'name = "payload"\nparameters = { mass_kg = 0.1, trials = 2 }',
            "trials is 2, expected a list of whole numbers",
        ),
        (
            'name = "payload"\nparameters = { mass_kg = 0.1, trials = [0] }',
            "trials is [0], expected a list of whole numbers",
        ),
        (
            'name = "gain_error"\njoints = [1]\nparameters = { factor = 0.5 }\n[[effect]]\n'
            'name = "gain_error"\njoints = [2, 1]\nparameters = { factor = 0.5 }',
            "effect[1]: joint 1 has the effect gain_error already",
        ),
    ],
)
def test_a_mistake_in_an_effect_is_a_sentence(effect, sentence):
    assert EFFECT in EVERYTHING
    (found,) = mistakes(EVERYTHING.replace(EFFECT, f"[[effect]]\n{effect}\n"), "it")
    assert found.startswith("it: effect[") and sentence in found


def test_effects_may_be_as_small_as_nothing():
    """Numbers that make an effect neutral are numbers it may have, even if they are infinite."""
    limit = '[[effect]]\nname = "torque_saturation"\njoints = [1, 2]\nparameters = { limit_N_m = inf }\n'
    arm = parse_arm(EVERYTHING.replace(EFFECT, limit), "it")
    assert arm.effects == (Effect("torque_saturation", {"limit_N_m": math.inf}, (1, 2)),)
    assert parse_arm(format_arm(arm), "it") == arm


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
