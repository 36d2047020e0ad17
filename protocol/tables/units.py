"""Units as people write them, in headers, rows of units and mappings, and what makes SI of them."""

import math
import re
from collections.abc import Collection
from dataclasses import dataclass

#: Standard gravity [m/s²], CGPM 1901: what a reading of 1 g means.
STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Unit:
    """A unit.

    Attributes
    ----------
    name : str
        As limbcal writes it.
    dimension : str
        What it measures, in words.
    factor : float
        What a number in it is multiplied by for SI.
    """

    name: str
    dimension: str
    factor: float


_ANGLE, _LENGTH, _TIME = "angle", "length", "time"
_DEG, _TURN = math.pi / 180.0, 2.0 * math.pi
#: Names, dimension, factor. The first name is the one that limbcal writes.
_UNITS: tuple[tuple[tuple[str, ...], str, float], ...] = (
    (("rad", "radian", "radians"), _ANGLE, 1.0),
    (("mrad",), _ANGLE, 1e-3),
    (("deg", "degree", "degrees"), _ANGLE, _DEG),
    (("rev", "turn", "turns"), _ANGLE, _TURN),
    (("m", "metre", "metres", "meter", "meters"), _LENGTH, 1.0),
    (("dm", "decimetre", "decimetres", "decimeter", "decimeters"), _LENGTH, 0.1),
    (("cm", "centimetre", "centimetres", "centimeter", "centimeters"), _LENGTH, 1e-2),
    (("mm", "millimetre", "millimetres", "millimeter", "millimeters"), _LENGTH, 1e-3),
    (("um", "micrometre", "micrometres", "micrometer", "micrometers", "micron", "microns"), _LENGTH, 1e-6),
    (("in", "inch", "inches"), _LENGTH, 0.0254),
    (("ft", "foot", "feet"), _LENGTH, 0.3048),
    (("s", "sec", "second", "seconds"), _TIME, 1.0),
    (("ms", "msec", "millisecond", "milliseconds"), _TIME, 1e-3),
    (("us", "usec", "microsecond", "microseconds"), _TIME, 1e-6),
    (("ns", "nsec", "nanosecond", "nanoseconds"), _TIME, 1e-9),
    (("rad/s",), "angular velocity", 1.0),
    (("deg/s", "dps"), "angular velocity", _DEG),
    (("rev/s",), "angular velocity", _TURN),
    (("rpm", "rev/min", "1/min"), "angular velocity", _TURN / 60.0),
    (("m/s",), "velocity", 1.0),
    (("mm/s",), "velocity", 1e-3),
    (("rad/s2", "rad/s/s"), "angular acceleration", 1.0),
    (("deg/s2", "deg/s/s"), "angular acceleration", _DEG),
    (("m/s2", "m/s/s", "ms-2", "m.s-2"), "acceleration", 1.0),
    (("mm/s2", "mm/s/s"), "acceleration", 1e-3),
    (("g", "g0"), "acceleration", STANDARD_GRAVITY),
    (("mg",), "acceleration", 1e-3 * STANDARD_GRAVITY),
    (("N.m", "Nm", "N-m"), "torque", 1.0),
    (("N.mm", "Nmm", "N-mm"), "torque", 1e-3),
    (("N.cm", "Ncm"), "torque", 1e-2),
    (("mN.m", "mNm"), "torque", 1e-3),
    (("kN.m", "kNm"), "torque", 1e3),
    (("N", "newton", "newtons"), "force", 1.0),
    (("mN",), "force", 1e-3),
    (("kN",), "force", 1e3),
)
_BY_NAME = {name: Unit(names[0], kind, factor) for names, kind, factor in _UNITS for name in names}
#: At the end of a name these are an input, a force-torque sensor or a part of the body.
_NO_SUFFIXES = ("in", "ft", "foot", "feet")
#: In the name of a column ``/`` and ``.`` are often ``_``: ``dq1_rad_s``, ``tau1_N_m``.
_BY_SUFFIX = {re.sub(r"[/.]", "_", name): unit for name, unit in _BY_NAME.items()} | _BY_NAME
_PLAIN = str.maketrans({"µ": "u", "μ": "u", "·": ".", "⋅": ".", "∙": ".", "*": ".", "²": "2", "⁻": "-", "^": None})
_BRACKETED = re.compile(r"(?P<name>.*?)[\s_]*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))")
_AFTER_SLASH = re.compile(r"(?P<name>.*\S)\s+(?:/\s*|in\s+)(?P<unit>\S+)")
#: What stands in a row of units below a column that has none.
_NONE = ("", "-", "–", "none", "n/a")

#: What may be measured by the columns of each role; a velocity may be named by its position's unit, per second.
DIMENSIONS: dict[str, tuple[str, ...]] = {
    "t": (_TIME,),
    "q": (_ANGLE, _LENGTH),
    "ref": (_ANGLE, _LENGTH),
    "dq": ("angular velocity", "velocity", _ANGLE, _LENGTH),
    "ddq": ("angular acceleration", "acceleration", _ANGLE, _LENGTH),
    "tau": ("torque", "force"),
    "tip": (_LENGTH,),
    "a": ("acceleration",),
    "gyro": ("angular velocity", _ANGLE),
}


def parse_unit(text: str) -> Unit | None:
    """Return the unit that a text names, or None if it is none that is known.

    Spellings with ``°``, ``µ``, ``·``, ``²``, ``^2``, ``**2`` or spaces are understood, with and without brackets.
    """
    plain = text.strip().strip("[](){}<>").strip().replace("**", "").translate(_PLAIN).replace("°", "deg")
    plain = re.sub(r"\s*([/.])\s*|\s+", lambda found: found[1] or ".", plain).replace("/sec", "/s")
    if plain in _BY_NAME:
        return _BY_NAME[plain]
    lower = plain.lower()
    # Deg, RAD, MS; but M and NM are no metres, and MG is no thousandth of g
    return _BY_NAME.get(lower) if len(lower) > 2 or lower in ("s", "ms", "us", "ns") else None


def known_units(dimensions: Collection[str]) -> str:
    """Return the units of some dimensions in words, for an error."""
    return ", ".join(dict.fromkeys(unit.name for unit in _BY_NAME.values() if unit.dimension in dimensions))


def is_no_unit(text: str) -> bool:
    """Say whether a cell of a row of units stands for none."""
    return text.strip().strip("[](){}").strip().lower() in _NONE


def split_unit(name: str) -> tuple[str, Unit | None, bool]:
    """Part the name of a column from the unit that stands in it.

    Returns
    -------
    bare : str
        The name without the unit, or all of it.
    unit : Unit or None
    certain : bool
        Whether it can be nothing but a unit: it stands in brackets, or is of more than one letter.
    """
    for pattern in (_BRACKETED, _AFTER_SLASH):
        found = pattern.fullmatch(name.strip())
        if found:
            text = next(part for part in found.groups()[1:] if part is not None)
            unit = parse_unit(text)
            if unit is not None and found["name"]:
                return found["name"].strip(), unit, True
    parts = name.strip().split("_")
    for k in range(1, len(parts)):
        suffix = "_".join(parts[k:])
        unit = None if suffix.lower() in _NO_SUFFIXES else _BY_SUFFIX.get(suffix) or parse_unit(suffix)
        bare = "_".join(parts[:k])
        if unit is not None and bare:
            return bare, unit, len(suffix) > 1
    return name, None, False
