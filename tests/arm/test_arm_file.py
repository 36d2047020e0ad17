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
from arm.model import Arm, Control, Effect, Estimate, Friction, Joint, Link, Marker, Sensor, Tip
from limbcal.errors import ConfigError, DeviceError
from tests.arm.every_table import EFFECT, EVERYTHING

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
NAME = st.text(st.characters().filter(lambda c: c.isprintable() and c not in "/\\"), min_size=1, max_size=64)
KEY = st.text(st.characters(codec="utf-8", exclude_characters="\0"))


def parameters(kind):
    """Return what draws the numbers of an effect."""
    required, optional = {}, {}
    for p in kind.parameters:
        one = st.integers(int(p.low), int(p.high)) if p.several else st.floats(p.low, p.high)
        (optional if p.optional else required)[p.name] = st.lists(one, max_size=3) if p.several else one
    return st.fixed_dictionaries(required, optional=optional)


@st.composite
def effects(draw, n_joint, sensors, markers):
    there = {"joints": range(1, n_joint + 1), "sensors": sensors, "markers": markers}
    kinds = [k for k in catalogue().values() if k.whole or len(there[k.acts_on]) >= (k.exactly or 1)]
    kind = draw(st.sampled_from(kinds))
    if kind.whole:
        return Effect(kind.name, draw(parameters(kind)))
    some = st.lists(
        st.sampled_from(there[kind.acts_on]), min_size=kind.exactly or 1, max_size=kind.exactly, unique=True
    )
    return Effect(kind.name, draw(parameters(kind)), **{kind.acts_on: tuple(draw(some))})


@st.composite
def arms(draw):
    joints = draw(st.lists(JOINT, min_size=1, max_size=4))
    names = draw(st.lists(NAME, max_size=4, unique=True))
    rides_on = st.integers(1, len(joints))
    sensors = [draw(st.builds(Sensor, st.just(n), rides_on, VECTOR, VECTOR, SCALE, VECTOR, LEAST)) for n in names]
    marked = draw(st.lists(NAME, max_size=3, unique=True))
    on_links = st.integers(0, len(joints))
    known = (on_links, VECTOR, st.none() | LEAST, st.none() | NAME)
    markers = [draw(st.builds(Marker, st.just(name), *known)) for name in marked]
    gains = st.tuples(*[NUMBER] * len(joints))
    last = [sensor.name for sensor in sensors if sensor.joint == len(joints)]
    return Arm(
        draw(NAME.filter(lambda name: not name.startswith("."))),
        tuple(joints),
        draw(VECTOR),
        tuple(sensors),
        draw(st.builds(Tip, st.sampled_from(last), VECTOR)) if last else None,
        draw(st.dictionaries(KEY, st.builds(Estimate, NUMBER, LEAST), max_size=3)),
        tuple(draw(st.lists(effects(len(joints), names, marked), unique_by=lambda effect: effect.name))),
        draw(
            st.just(Control())
            | st.builds(Control, st.just("pd"), gains, gains)
            | st.builds(Control, st.just("pda"), gains, gains, gains)
            | st.builds(Control, st.just("p"), gains)
        ),
        markers=tuple(markers),
    )


@FEW
@given(arms())
def test_what_is_written_is_read_again(arm):
    text = format_arm(arm)
    again = parse_arm(text, "it")
    assert again == arm
    assert format_arm(again) == text


def test_a_file_holds_an_arm(tmp_path, dd_arm):
    save_arm(dd_arm, tmp_path / "arm.toml")
    assert load_arm(tmp_path / "arm.toml") == dd_arm
    assert load_arm(str(tmp_path / "arm.toml")) == dd_arm


def test_a_standard_error_that_nobody_knows_is_left_out(dd_arm):
    arm = replace(dd_arm, base_parameters={"I2": Estimate(0.47), "m2*sx2": Estimate(1.7, 0.1)})
    assert '"m2*sx2" = { value = 1.7, std = 0.1 }' in format_arm(arm)
    again = parse_arm(format_arm(arm), "it").base_parameters
    assert math.isnan(again["I2"].std) and again["m2*sx2"] == Estimate(1.7, 0.1)


def test_a_calibrated_file_says_next_to_its_masses_that_only_sums_are_known(dd_arm):
    learnt = replace(dd_arm, base_parameters={"I2": Estimate(0.47, 0.001)})
    text = format_arm(learnt)
    links = [line for line in text.splitlines() if line.startswith("link = ")]
    assert len(links) == 2 and all(
        line.endswith("# one choice of many: only [base_parameters] is known") for line in links
    )
    assert "# Motion reveals only sums" in text[: text.index("[[joint]]")]
    assert parse_arm(text, "it") == learnt
    assert "#" not in format_arm(replace(dd_arm, base_parameters={}))


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
    limbs = ["human-arm-left", "human-arm-right", "human-leg-left", "human-leg-right"]
    assert preset_names() == ["dd-arm", "dd-arm-vertical", *limbs[:2], "human-body", *limbs[2:], "spatial-arm"]
    for name in preset_names():
        assert load_arm(name).name == name


def test_the_dd_arm_is_that_of_tables_2_and_3(dd_arm, vertical_arm):
    assert [joint.a_m for joint in dd_arm.joints] == [0.25, 0.3]
    assert dd_arm.gravity_m_s2 == (0.0, 0.0, -9.80665)
    assert [(s.joint, s.position_m[0]) for s in dd_arm.sensors] == [(1, 0.1), (1, 0.24), (2, 0.08), (2, 0.28)]
    assert dd_arm.control == Control("pd", (9.5, 9.5), (-9.5, -9.5))
    hung = replace(vertical_arm, name="dd-arm", gravity_m_s2=dd_arm.gravity_m_s2)
    assert hung == dd_arm and vertical_arm.gravity_m_s2 == (0.0, -9.80665, 0.0)


def test_every_table_of_schema_1_is_read():
    arm = parse_arm(EVERYTHING, "it")
    assert arm.joints[0].link == Link(1.0, (0.1, 0.0, 0.0), (0.01, 0.01, 0.02, 0.0, 0.0, 0.0))
    assert arm.joints[0].length_std_m == 0.0005
    assert arm.joints[1] == Joint(parent=1, parent_position_m=(0.2, 0.0, 0.05))
    scale, bias_m_s2 = (1.002, 0.998, 1.0), (0.01, -0.02, 0.0)
    assert arm.sensors[0] == Sensor("s1", 1, (0.1, 0.0, 0.0), (0.0, 0.0, 0.0), scale, bias_m_s2, 0.1)
    assert arm.sensors[1] == Sensor("s4", 2)
    assert arm.tip == Tip("s4", (0.02, 0.0, 0.0))
    assert arm.base_parameters == {"I1+m2*L1^2": Estimate(1.986076, 0.0004)}
    assert arm.effects == (Effect("gravity_tilt", {"gx_m_s2": 0.31, "gy_m_s2": -0.12}),)
    assert parse_arm(format_arm(arm), "it") == arm


def test_a_file_that_cannot_be_written_is_named(tmp_path, dd_arm):
    with pytest.raises(DeviceError, match=r"nowhere/arm.toml: cannot be written: No such file or directory"):
        save_arm(dd_arm, tmp_path / "nowhere" / "arm.toml")


def test_the_presets_are_written_as_people_would(dd_arm):
    """Every line of the written file is TOML that a reader can change by hand."""
    text = format_arm(dd_arm)
    assert tomllib.loads(text)["joint"][1]["a_m"] == 0.3
    assert "np." not in text and max(map(len, text.splitlines())) < 160


def test_effects_may_be_as_small_as_nothing():
    """Numbers that make an effect neutral are numbers it may have, even if they are infinite."""
    limit = '[[effect]]\nname = "torque_saturation"\njoints = [1, 2]\nparameters = { limit_N_m = inf }\n'
    arm = parse_arm(EVERYTHING.replace(EFFECT, limit), "it")
    assert arm.effects == (Effect("torque_saturation", {"limit_N_m": math.inf}, (1, 2)),)
    assert parse_arm(format_arm(arm), "it") == arm


def test_what_is_no_toml_is_told_with_its_line():
    with pytest.raises(ConfigError, match="arm.toml: not TOML: .*line 3"):
        parse_arm('schema = 1\nname = "x"\ngravity = [0.0,, 1.0]\n', "arm.toml")


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
