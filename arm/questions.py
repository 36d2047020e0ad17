"""What in an arm file is hardly meant: lengths in millimetres, angles in degrees, and what no arm can have.

A file that may be right is not refused: each doubt is a note that names the field, what it is and what is meant.
"""

import math
from collections.abc import Iterator

from arm.model import Arm, Body, Joint, Sensor
from arm.possible import impossibilities
from limbcal.note import Note

#: No link or lever of an arm or leg is longer: the largest industrial robots reach 5 m in all [m].
_LONGEST_M = 10.0
#: Lengths beyond this are hardly centimetres [m].
_CENTIMETRES_M = 100.0
#: A file has no need of an angle beyond a whole turn [rad].
_TURN_RAD = 2.0 * math.pi * (1.0 + 1e-9)
#: Gravity on bodies that have been landed on is between the asteroid Ceres' and twice the earth's [m/s^2].
_GRAVITY_M_S2 = (0.25, 20.0)
#: No link is heavier [kg].
_HEAVIEST_KG = 1000.0
#: From a newborn to the heaviest and tallest who were measured [kg, m].
_BODY_KG, _BODY_M = (1.0, 650.0), (0.3, 2.8)
#: An accelerometer's zero is hardly off by more [m/s^2].
_BIAS_M_S2 = 10.0


def questions_of(arm: Arm, source: str = "") -> tuple[Note, ...]:
    """Return a note for each number of an arm that looks as if it were in another unit, or that no arm can have.

    Their kinds are ``unit`` and ``impossible``.

    Parameters
    ----------
    arm : Arm
    source : str
        Its file or name, for the notes.
    """
    units = [Note("unit", text, source, (field,)) for field, text in _doubts(arm)]
    doubted = {_table_of(note.columns[0]) for note in units}  # a mass in grams makes no body either
    return (
        *units,
        *(
            Note("impossible", text, source, (field,))
            for field, text in impossibilities(arm)
            if _table_of(field) not in doubted
        ),
    )


def _table_of(field: str) -> str:
    return field.rpartition(".")[0]


def _doubts(arm: Arm) -> Iterator[tuple[str, str]]:
    size = math.hypot(*arm.gravity_m_s2)
    if size > 0.0 and not _GRAVITY_M_S2[0] <= size <= _GRAVITY_M_S2[1]:
        yield _said("gravity_m_s2", list(arm.gravity_m_s2), "mm/s²?", "m/s²")
    elif 0.9 <= size <= 1.1:
        yield _said("gravity_m_s2", list(arm.gravity_m_s2), "g?", "m/s², about 9.81 in all on earth")
    for k, joint in enumerate(arm.joints):
        yield from _of_joint(f"joint[{k}]", joint)
    for k, sensor in enumerate(arm.sensors):
        yield from _of_sensor(f"sensor[{k}]", sensor)
    if arm.tip is not None:
        yield from _lengths("tip.offset_m", arm.tip.offset_m)
    if arm.body is not None:
        yield from _of_body(arm.body)


def _of_body(body: Body) -> Iterator[tuple[str, str]]:
    for field, value, (least, most), less, more, expected in (
        ("body.mass_kg", body.mass_kg, _BODY_KG, "tonnes?", "grams?", "kilograms"),
        ("body.height_m", body.height_m, _BODY_M, "not a body's height?", "centimetres?", "metres"),
    ):
        if not least <= value <= most:
            yield _said(field, value, less if value < least else more, expected)


def _of_joint(name: str, joint: Joint) -> Iterator[tuple[str, str]]:
    for field in ("alpha_rad", "beta_rad", "theta_offset_rad"):
        yield from _angles(f"{name}.{field}", (getattr(joint, field),))
    for field in ("a_m", "d_m"):
        yield from _lengths(f"{name}.{field}", (getattr(joint, field),))
    if joint.length_std_m is not None:
        yield from _lengths(f"{name}.length_std_m", (joint.length_std_m,))
    if joint.limits is not None and joint.type == "prismatic":
        yield from _lengths(f"{name}.limits", joint.limits)
    elif joint.limits is not None and max(map(abs, joint.limits)) > 2.0 * _TURN_RAD:  # a cable may wind up
        yield from _angles(f"{name}.limits", joint.limits)
    link = joint.link
    yield from _lengths(f"{name}.link.com_m", link.com_m)
    if abs(link.mass_kg) > _HEAVIEST_KG:
        yield _said(f"{name}.link.mass_kg", link.mass_kg, "grams?", "kilograms")
    if max(map(abs, link.inertia_kg_m2)) > max(abs(link.mass_kg), 1.0) * _LONGEST_M**2:
        yield _said(f"{name}.link.inertia_kg_m2", list(link.inertia_kg_m2), "kg·mm² or g·mm²?", "kg·m²")


def _of_sensor(name: str, sensor: Sensor) -> Iterator[tuple[str, str]]:
    yield from _lengths(f"{name}.position_m", sensor.position_m)
    yield from _angles(f"{name}.rotation_rad", sensor.rotation_rad)
    if max(map(abs, sensor.bias_m_s2)) > _BIAS_M_S2:
        yield _said(f"{name}.bias_m_s2", list(sensor.bias_m_s2), "with gravity in it, or mm/s²?", "m/s²")


def _lengths(field: str, values: tuple[float, ...]) -> Iterator[tuple[str, str]]:
    longest = max(map(abs, values))
    if longest > _LONGEST_M:
        likely = "millimetres?" if longest > _CENTIMETRES_M else "millimetres or centimetres?"
        yield _said(field, values[0] if len(values) == 1 else list(values), likely, "metres")


def _angles(field: str, values: tuple[float, ...]) -> Iterator[tuple[str, str]]:
    if max(map(abs, values)) > _TURN_RAD:
        yield _said(field, values[0] if len(values) == 1 else list(values), "degrees?", "radians")


def _said(field: str, value: float | list[float], likely: str, expected: str) -> tuple[str, str]:
    shown = f"{value:g}" if isinstance(value, float | int) else f"[{', '.join(f'{x:g}' for x in value)}]"
    return field, f"{field} is {shown}: {likely} expected {expected}"
