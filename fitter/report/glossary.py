"""What the symbols of fitted parameters mean, for an arm of any number of joints."""

import re
from collections.abc import Iterable

#: Parameters that stand alone, by the form of their names; the number is the joint's.
_ALONE = {
    r"alpha\d+": ("alpha_j", "turn of joint j's axis about x, eq. (1): its tilt against the axis before it"),
    r"beta\d+": ("beta_j", "turn of joint j's axis about y, eq. (1): its tilt against the axis before it"),
    r"a\d+": ("a_j", "length of link j, from its joint axis to its far end, along x"),
    r"d\d+": ("d_j", "offset of link j along its joint axis z"),
    r"theta_offset\d+": ("theta_offset_j", "angle of link j where its joint reads zero"),
    r"D\d+": ("D_j", "viscous friction of joint j: torque per joint speed"),
    r"fc\d+": ("fc_j", "Coulomb friction of joint j: a torque of constant size against its motion"),
    r"F\d+": ("F_j", "static friction of joint j: the torque that it takes to set it moving from rest"),
    r"kp\d+": ("kp_j", "gain of the control law on joint j's error of position"),
    r"kv\d+": ("kv_j", "gain of the control law on joint j's speed"),
    r"ka\d+": ("ka_j", "gain of the control law on joint j's acceleration"),
    r"bias_[xyz]": ("bias_x, _y, _z", "reading of the sensor at zero acceleration, along its axes"),
    r"scale_[xyz]": ("scale_x, _y, _z", "factor between acceleration and reading, along the sensor's axes"),
    r"turn_[xyz]": (
        "turn_x, _y, _z",
        "turn of the sensor against the arm file, about its axes",
    ),
    r"place_[xyz]": (
        "place_x, _y, _z",
        "place of the sensor against the arm file, along the link's axes",
    ),
    r"highpass_hz": ("highpass_hz", "corner frequency of the AC coupling of the sensor"),
}
#: Symbols within a sum of inertial parameters.
_WITHIN = {
    r"m\d+": ("m_j", "mass of link j"),
    r"s[xyz]\d+": (
        "sx_j, sy_j, sz_j",
        "centre of mass of link j, in the link's frame: origin on the joint axis, x along the link, z the axis",
    ),
    r"I\d+": ("I_j", "moment of inertia of link j about its own joint axis"),
    r"I\d+(xx|yy|zz)": ("Ixx_j, Iyy_j, Izz_j (I2xx, …)", "moments of inertia of link j about its frame's axes"),
    r"I\d+(xy|xz|yz)": ("Ixy_j, Ixz_j, Iyz_j (I2xy, …)", "products of inertia of link j"),
    r"L\d+": ("L_j", "length of link j (a_j of the geometry)"),
    r"d\d+": ("d_j", "offset of link j along its joint axis z"),
}
_FIRST_MOMENT = r"m\d+\*s[xyz]\d+"
_SYMBOL = re.compile(r"[A-Za-z_]+\d*(?:xx|yy|zz|xy|xz|yz)?")


def glossary(names: Iterable[str]) -> list[tuple[str, str]]:
    """Return what each kind of symbol in the names of parameters means: symbol and meaning, each kind once.

    Parameters
    ----------
    names : iterable of str
        Such as ``I1+m2*L1^2``, ``m2*sx2``, ``D1``, ``alpha2``.
    """
    found: dict[str, str] = {}
    summed = False
    for name in names:
        alone = _meaning(name, _ALONE)
        if alone is not None:
            found.setdefault(*alone)
            continue
        if re.search(_FIRST_MOMENT, name):
            found.setdefault("m_j*sx_j, …", "first moment of link j: its mass times where its centre of mass is")
        symbols = _SYMBOL.findall(name)
        summed = summed or len(symbols) > 1
        for symbol in symbols:
            within = _meaning(symbol, _WITHIN)
            if within is not None:
                found.setdefault(*within)
    rows = list(found.items())
    if summed:
        rows.append(
            (
                "sums such as I1+m2*L1^2",
                "base parameters: only these sums move the arm, so only they can be learnt; masses and inertias "
                "of single links cannot be distinguished from motion",
            )
        )
    return rows


def _meaning(name: str, meanings: dict[str, tuple[str, str]]) -> tuple[str, str] | None:
    for form, row in meanings.items():
        if re.fullmatch(form, name):
            return row
    return None
