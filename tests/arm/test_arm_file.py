"""Arm files: there and back again, and every mistake named."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import format_arm, load_arm, parse_arm, preset_names, save_arm
from arm.effects.catalogue import catalogue
from arm.model import Arm, Control, Effect, Estimate, Friction, Joint, Link, Sensor, Tip
from limbcal.errors import ConfigError, DeviceError

FEW = settings(max_examples=60, deadline=None)
NUMBER = st.floats(allow_nan=False, allow_infinity=False)
VECTOR = st.tuples(NUMBER, NUMBER, NUMBER)
FRICTION = st.builds(Friction, NUMBER, NUMBER, NUMBER)
LINK = st.builds(Link, NUMBER, VECTOR, st.tuples(*[NUMBER] * 6))
LEAST = st.floats(0.0, allow_infinity=False)
JOINT = st.builds(
    Joint,
    st.sampled_from(["revolute", "prismatic"]),
    *[NUMBER] * 5,
    length_std_m=st.none() | LEAST,
    limits=st.none() | st.sets(NUMBER, min_size=2, max_size=2).map(sorted).map(tuple),
    friction=FRICTION,
    link=LINK,
)
SCALE = st.tuples(*[st.floats(0.0, exclude_min=True, allow_infinity=False)] * 3)
NAME = st.text(min_size=1)


def parameters(kind):
    """Return what draws the numbers of an effect."""
    required, optional = {}, {}
    for p in kind.parameters:
        one = st.integers(int(p.low), int(p.high)) if p.several else st.floats(p.low, p.high)
        (optional if p.optional else required)[p.name] = st.lists(one, max_size=3) if p.several else one
    return st.fixed_dictionaries(required, optional=optional)


@st.composite
def effects(draw, n_joint, sensors):
    kinds = [kind for kind in catalogue().values() if sensors or kind.whole or kind.place != "sensor"]
    kind = draw(st.sampled_from(kinds))
    on = st.sampled_from(sensors) if kind.place == "sensor" and sensors else st.integers(1, n_joint)
    some = () if kind.whole else tuple(draw(st.lists(on, min_size=1, unique=True)))
    acts_on = {"sensors" if kind.place == "sensor" else "joints": some}
    return Effect(kind.name, draw(parameters(kind)), **acts_on)


@st.composite
def arms(draw):
    joints = draw(st.lists(JOINT, min_size=1, max_size=4))
    names = draw(st.lists(NAME, max_size=4, unique=True))
    rides_on = st.integers(1, len(joints))
    sensors = [draw(st.builds(Sensor, st.just(n), rides_on, VECTOR, VECTOR, SCALE, VECTOR, LEAST)) for n in names]
    gains = st.tuples(*[NUMBER] * len(joints))
    return Arm(
        draw(st.text()),
        tuple(joints),
        draw(VECTOR),
        tuple(sensors),
        draw(st.builds(Tip, st.sampled_from(names), VECTOR)) if names else None,
        draw(st.dictionaries(st.text(), st.builds(Estimate, NUMBER, NUMBER), max_size=3)),
        tuple(draw(st.lists(effects(len(joints), names), unique_by=lambda effect: effect.name))),
        draw(
            st.just(Control())
            | st.builds(Control, st.just("pd"), gains, gains)
            | st.builds(Control, st.just("pda"), gains, gains, gains)
            | st.builds(Control, st.just("p"), gains)
        ),
    )


@FEW
@given(arms())
def test_what_is_written_is_read_again(arm):
    text = format_arm(arm)
    assert parse_arm(text, "it") == arm
    assert format_arm(parse_arm(text, "it")) == text


def test_a_file_holds_an_arm(tmp_path, dd_arm):
    save_arm(dd_arm, tmp_path / "arm.toml")
    assert load_arm(tmp_path / "arm.toml") == dd_arm
    assert load_arm(str(tmp_path / "arm.toml")) == dd_arm


def test_a_standard_error_that_nobody_knows_is_left_out(dd_arm):
    arm = replace(dd_arm, base_parameters={"I2": Estimate(0.47), "m2*sx2": Estimate(1.7, 0.1)})
    assert '"m2*sx2" = { value = 1.7, std = 0.1 }' in format_arm(arm)
    again = parse_arm(format_arm(arm), "it").base_parameters
    assert math.isnan(again["I2"].std) and again["m2*sx2"] == Estimate(1.7, 0.1)


def test_lengths_of_which_nobody_says_how_well_they_are_known(dd_arm):
    assert "length_std_m" not in format_arm(dd_arm)
    exact = replace(dd_arm, joints=tuple(replace(joint, length_std_m=0.0) for joint in dd_arm.joints))
    assert format_arm(exact).count("length_std_m = 0.0") == 2
    assert parse_arm(format_arm(exact), "it") == exact


def test_numbers_of_numpy_are_numbers(dd_arm):
    """What a fit found comes as numpy's scalars and arrays."""
    arm = replace(
        dd_arm,
        gravity_m_s2=tuple(np.array([0.0, 1.0, -9.5])),
        base_parameters={"I2": Estimate(np.float64(0.47), np.float32(0.5))},
        effects=(
            Effect("payload", {"mass_kg": np.float32(0.5), "trials": np.array([1, 3])}),
            Effect("viscous", {"viscous_N_m_s": np.int64(2)}, joints=(np.int64(2),)),
        ),
    )
    again = parse_arm(format_arm(arm), "it")
    assert again.gravity_m_s2 == (0.0, 1.0, -9.5) and again.base_parameters == {"I2": Estimate(0.47, 0.5)}
    assert again.effects == (
        Effect("payload", {"mass_kg": 0.5, "trials": [1, 3]}),
        Effect("viscous", {"viscous_N_m_s": 2}, (2,)),
    )


def test_presets_are_known_by_name():
    assert preset_names() == ["dd-arm", "dd-arm-vertical", "spatial-arm"]
    for name in preset_names():
        assert load_arm(name).name == name


def test_the_dd_arm_is_that_of_tables_2_and_3(dd_arm, vertical_arm):
    assert [joint.a_m for joint in dd_arm.joints] == [0.25, 0.3]
    assert dd_arm.gravity_m_s2 == (0.0, 0.0, -9.80665)
    assert [(s.joint, s.position_m[0]) for s in dd_arm.sensors] == [(1, 0.1), (1, 0.24), (2, 0.08), (2, 0.28)]
    assert dd_arm.control == Control("pd", (9.5, 9.5), (-9.5, -9.5))
    hung = replace(vertical_arm, name="dd-arm", gravity_m_s2=dd_arm.gravity_m_s2)
    assert hung == dd_arm and vertical_arm.gravity_m_s2 == (0.0, -9.80665, 0.0)


EVERYTHING = """
schema = 1
name = "dd-arm"
gravity_m_s2 = [0.0, 0.0, -9.80665]        # in the base frame; the DD arm moves in the x-y plane

[[joint]]
type = "revolute"                           # or "prismatic"
alpha_rad = 0.0
a_m = 0.25
d_m = 0.0
beta_rad = 0.0
theta_offset_rad = 0.0
length_std_m = 0.0005                       # how well a_m and d_m are known; left out: guesses
friction = { viscous_N_m_s = 0.0, coulomb_N_m = 0.0, static_N_m = 0.0 }
link = { mass_kg = 1.0, com_m = [0.1, 0.0, 0.0], inertia_kg_m2 = [0.01, 0.01, 0.02, 0.0, 0.0, 0.0] }

[[joint]]

[[sensor]]                                  # a triaxial accelerometer
name = "s1"
joint = 1                                   # the link it rides on
position_m = [0.10, 0.0, 0.0]               # in the link's joint-axis frame
rotation_rad = [0.0, 0.0, 0.0]              # link -> sensor, roll pitch yaw
scale = [1.002, 0.998, 1.0]                 # what it reads for one m/s^2
bias_m_s2 = [0.01, -0.02, 0.0]              # what it reads for none
highpass_hz = 0.1                           # the corner of an AC-coupled one; 0: DC

[[sensor]]
name = "s4"
joint = 2

[tip]                                       # what measures r*
sensor = "s4"
offset_m = [0.02, 0.0, 0.0]                 # in the link's frame

[base_parameters]                           # what a calibration really identified: value and standard error
"I1+m2*L1^2" = { value = 1.986076, std = 0.0004 }

[[effect]]                                  # what a diagnosis added to the simulation
name = "gravity_tilt"
parameters = { gx_m_s2 = 0.31, gy_m_s2 = -0.12 }

[control]                                   # eq. (5), (6), (7): tau = kp (ref - q) + kv dq + ka ddq
law = "pd"                                  # "pd" (5), "pda" (6), "p" (7), or "measured"
kp = [9.5, 9.5]
kv = [-9.5, -9.5]
"""


def test_every_table_of_schema_1_is_read():
    arm = parse_arm(EVERYTHING, "it")
    assert arm.joints[0].link == Link(1.0, (0.1, 0.0, 0.0), (0.01, 0.01, 0.02, 0.0, 0.0, 0.0))
    assert arm.joints[0].length_std_m == 0.0005
    assert arm.joints[1] == Joint() and arm.joints[1].length_std_m is None
    scale, bias_m_s2 = (1.002, 0.998, 1.0), (0.01, -0.02, 0.0)
    assert arm.sensors[0] == Sensor("s1", 1, (0.1, 0.0, 0.0), (0.0, 0.0, 0.0), scale, bias_m_s2, 0.1)
    assert arm.sensors[1] == Sensor("s4", 2)
    assert arm.tip == Tip("s4", (0.02, 0.0, 0.0))
    assert arm.base_parameters == {"I1+m2*L1^2": Estimate(1.986076, 0.0004)}
    assert arm.effects == (Effect("gravity_tilt", {"gx_m_s2": 0.31, "gy_m_s2": -0.12}),)
    assert parse_arm(format_arm(arm), "it") == arm


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
    assert found[1] == "arm.toml: joint[0].dm is not a known field"
    assert found[2].startswith("arm.toml: control.law is 'pid'; input should be 'pd', 'pda', 'p' or 'measured'")


def test_mistakes_in_a_field_do_not_hide_those_between_fields():
    text = EVERYTHING.replace("a_m = 0.25", "a_m = true").replace('sensor = "s4"', 'sensor = "s9"')
    text = text.replace("kp = [9.5, 9.5]", "kp = [9.5]").replace("joint = 2", "joint = 3")
    text = text.replace('name = "s4"', 'name = "s1"')
    found = mistakes(text)
    assert found[0].startswith("arm.toml: joint[0].a_m is True;")
    assert set(found[1:]) == {
        "arm.toml: sensor[1].joint is 3, expected 1 to 2",
        "arm.toml: sensor[1].name is 's1', which sensor[0] has already",
        "arm.toml: tip.sensor is 's9', expected one of s1, s1",
        "arm.toml: control.kp has 1 numbers, expected one a joint (2)",
    }


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("schema = 1", "schema = 2"), "it: schema is 2; input should be 1"),
        (("schema = 1\n", ""), "it: schema is missing"),
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
        "dd-arm, dd-arm-vertical, spatial-arm"
    )
    with pytest.raises(ConfigError, match="Is a directory"):
        load_arm(tmp_path)
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(ConfigError, match="it is not UTF-8 text"):
        load_arm(tmp_path / "bytes.toml")


def test_a_file_that_cannot_be_written_is_named(tmp_path, dd_arm):
    with pytest.raises(DeviceError, match=r"nowhere/arm.toml: cannot be written: No such file or directory"):
        save_arm(dd_arm, tmp_path / "nowhere" / "arm.toml")


def test_the_presets_are_written_as_people_would(dd_arm):
    """Every line of the written file is TOML that a reader can change by hand."""
    text = format_arm(dd_arm)
    assert tomllib.loads(text)["joint"][1]["a_m"] == 0.3
    assert "np." not in text and max(map(len, text.splitlines())) < 160


EFFECT = """[[effect]]                                  # what a diagnosis added to the simulation
name = "gravity_tilt"
parameters = { gx_m_s2 = 0.31, gy_m_s2 = -0.12 }
"""


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
