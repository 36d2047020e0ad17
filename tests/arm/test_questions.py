"""Arms in other units are questioned by the field; real ones are not."""

from dataclasses import replace

import pytest

from arm.arm_file import load_arm, parse_arm, preset_names
from arm.model import Body
from arm.questions import questions_of

ARM = """
schema = 1
name = "mine"
gravity_m_s2 = {gravity}
[[joint]]
type = "{kind}"
alpha_rad = {alpha}
a_m = {a}
limits = {limits}
link = {{ mass_kg = {mass}, com_m = [{com}, 0.0, 0.0], inertia_kg_m2 = [0.0, 0.0, {inertia}, 0.0, 0.0, 0.0] }}
[[sensor]]
name = "s1"
joint = 1
position_m = [{place}, 0.0, 0.0]
rotation_rad = [0.0, 0.0, {turned}]
"""
PLAIN = {
    "gravity": [0.0, 0.0, -9.81],
    "kind": "revolute",
    "alpha": 1.57,
    "a": 0.3,
    "limits": [-3.0, 6.4],
    "mass": 2.0,
    "com": 0.1,
    "inertia": 0.05,
    "place": 0.1,
    "turned": -3.14,
}


@pytest.mark.parametrize("name", preset_names())
def test_built_in_arms_are_not_doubted(name: str) -> None:
    assert questions_of(load_arm(name)) == ()


def test_a_real_arm_is_not_doubted() -> None:
    assert questions_of(parse_arm(ARM.format(**PLAIN), "arm.toml")) == ()


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"a": 300.0}, "joint[0].a_m is 300: millimetres? expected metres"),
        ({"a": -45.0}, "joint[0].a_m is -45: millimetres or centimetres? expected metres"),
        ({"alpha": 90.0}, "joint[0].alpha_rad is 90: degrees? expected radians"),
        ({"limits": [-170.0, 170.0]}, "joint[0].limits is [-170, 170]: degrees? expected radians"),
        (
            {"kind": "prismatic", "limits": [0.0, 400.0]},
            "joint[0].limits is [0, 400]: millimetres? expected metres",
        ),
        ({"com": 120.0}, "joint[0].link.com_m is [120, 0, 0]: millimetres? expected metres"),
        ({"mass": 2500.0}, "joint[0].link.mass_kg is 2500: grams? expected kilograms"),
        (
            {"inertia": 50_000.0},
            "joint[0].link.inertia_kg_m2 is [0, 0, 50000, 0, 0, 0]: kg·mm² or g·mm²? expected kg·m²",
        ),
        ({"place": 100.5}, "sensor[0].position_m is [100.5, 0, 0]: millimetres? expected metres"),
        ({"turned": 180.0}, "sensor[0].rotation_rad is [0, 0, 180]: degrees? expected radians"),
        ({"gravity": [0.0, 0.0, -9810.0]}, "gravity_m_s2 is [0, 0, -9810]: mm/s²? expected m/s²"),
        (
            {"gravity": [0.0, -1.0, 0.0]},
            "gravity_m_s2 is [0, -1, 0]: g? expected m/s², about 9.81 in all on earth",
        ),
    ],
)
def test_another_unit_is_questioned(changed: dict[str, object], text: str) -> None:
    (note,) = questions_of(parse_arm(ARM.format(**{**PLAIN, **changed}), "arm.toml"), "arm.toml")
    assert (note.kind, note.source, note.text) == ("unit", "arm.toml", text)
    assert note.columns == (text.split(" is ", maxsplit=1)[0],)


@pytest.mark.parametrize(
    ("body", "text"),
    [
        (Body("human-body", 70.0, 175.0, "f"), "body.height_m is 175: centimetres? expected metres"),
        (Body("human-body", 70000.0, 1.75, "f"), "body.mass_kg is 70000: grams? expected kilograms"),
    ],
)
def test_a_body_in_another_unit_is_questioned(body: Body, text: str) -> None:
    assert [note.text for note in questions_of(replace(load_arm("dd-arm"), body=body))] == [text]


def test_what_no_arm_can_have_is_a_note_of_its_kind() -> None:
    (note,) = questions_of(parse_arm(ARM.format(**{**PLAIN, "mass": -1.0}), "arm.toml"), "arm.toml")
    assert (note.kind, note.source, note.columns) == ("impossible", "arm.toml", ("joint[0].link.mass_kg",))


def test_each_field_is_a_note_of_its_own() -> None:
    arm = parse_arm(ARM.format(**{**PLAIN, "a": 300.0, "alpha": 90.0}), "arm.toml")
    assert [note.columns[0] for note in questions_of(arm)] == ["joint[0].alpha_rad", "joint[0].a_m"]
    free = replace(arm, gravity_m_s2=(0.0, 0.0, 0.0))
    assert len(questions_of(free)) == 2
