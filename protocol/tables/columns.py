"""Which column of a foreign file plays which role: ``"t=time,q=pos_meas{j},tau=tau_meas{j}"``."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from limbcal.errors import ConfigError
from protocol.tables.units import DIMENSIONS, Unit, known_units, parse_unit

#: What a joint's drive does: whether it is engaged (0 or 1), and its gains where they overrule ``[control]``. One
#: column, or one number of the file, may serve all joints.
DRIVE_ROLES = ("on", "kp", "kv")
#: Roles that have one column a joint; ``q`` stands for q1 … qn, ``q2`` for one of them.
JOINT_ROLES = ("q", "dq", "ddq", "tau", "ref", *DRIVE_ROLES)
TIP_ROLES = ("tipx", "tipy", "tipz")
#: The pose in the world of the segment that carries the base: its place [m], then a unit quaternion.
BASE_PLACE, BASE_QUATERNION = ("base_x", "base_y", "base_z"), ("base_qw", "base_qx", "base_qy", "base_qz")
BASE_ROLES = (*BASE_PLACE, *BASE_QUATERNION)
PLAIN_ROLES = ("t", "trial", *TIP_ROLES, *BASE_ROLES)

_PLACEHOLDER = re.compile(r"\{j(?:([+-])(\d+))?\}")
_NUMBERED = re.compile(rf"({'|'.join(JOINT_ROLES)})([1-9]\d*)")


@dataclass(frozen=True)
class Address:
    """Where a role is found.

    Attributes
    ----------
    role : str
        The canonical name, with the joint's number: ``t``, ``q2``, ``tipx``.
    text : str
        The name of a column, or the way to an array in a ``.mat`` or ``.json``.
    asked : bool
        The mapping named it, so it must be there; otherwise it is only looked for by its own name.
    unit : Unit, optional
        What the mapping says its numbers are in.
    dimensions : tuple of str
        What its numbers can measure.
    """

    role: str
    text: str
    asked: bool
    unit: Unit | None = None
    dimensions: tuple[str, ...] = ()


@dataclass(frozen=True)
class ColumnMap:
    """Roles and the addresses that a mapping gave them; whatever it leaves out goes by its own name.

    Attributes
    ----------
    entries : mapping of str to str
        Addresses by role.
    units : mapping of str to Unit
        By role, where the mapping names one.
    rates : collection of str
        Plain roles that are angular velocities, of gyroscopes; others that are not named here are accelerations.
    """

    entries: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, Unit] = field(default_factory=dict)
    rates: Collection[str] = ()

    def plain(self, role: str) -> Address | None:
        """Return where a role without a joint number is found, or None if it was mapped to nothing."""
        dimensions = dimensions_of("gyro" if role in self.rates else role)
        if role not in self.entries:
            return Address(role, role, asked=False, dimensions=dimensions)
        text = self.entries[role]
        return Address(role, text, True, self.units.get(role), dimensions) if text else None

    def joint(self, role: str, number: int) -> Address | None:
        """Return where a role of one joint (counted from 1) is found, or None if it was mapped to nothing."""
        own = f"{role}{number}"
        if own in self.entries or role not in self.entries:
            return self.plain(own)
        text = _PLACEHOLDER.sub(lambda found: _count(found, number), self.entries[role])
        return Address(own, text, True, self.units.get(role), dimensions_of(own)) if text else None

    def numbers_joints(self, role: str) -> bool:
        """Say whether the number of a role's columns follows from the file, not from the mapping."""
        return role not in self.entries or bool(_PLACEHOLDER.search(self.entries[role]))


def parse_mapping(
    text: str | None, n_joint: int, other_roles: Sequence[str] = (), rates: Sequence[str] = ()
) -> ColumnMap:
    """Read a mapping of roles to foreign columns.

    Parameters
    ----------
    text : str or None
        Entries ``role=address`` parted by commas. Roles are ``t``, ``trial``, ``tipx tipy tipz``, the base's pose
        ``base_x base_y base_z base_qw base_qx base_qy base_qz`` and, with one
        column a joint, ``q dq ddq tau ref on kp kv``: there ``{j}`` in the address stands for the joint's number
        from 1, ``{j+2}`` for the number plus two, and single joints can be named (``q1=shoulder,q2=elbow``). A
        unit may follow a colon (``q=angle{j}:deg``). What is no column may be a sum of columns, see
        `protocol.tables.sums`, a number alone in the place of ``t`` the step. An empty address (``dq=``) leaves a
        column that is there unused. None: every column goes by its own name.
    n_joint : int
        Number of joints of the arm.
    other_roles : sequence of str, optional
        Further plain roles: the axes of accelerometers.
    rates : sequence of str, optional
        And those of gyroscopes.

    Returns
    -------
    ColumnMap

    Raises
    ------
    ConfigError
        Listing every mistake: an entry without ``=``, a role that does not exist or is given twice, a joint
        number that the arm does not have, ``{j}`` missing or out of place.
    """
    entries: dict[str, str] = {}
    units: dict[str, Unit] = {}
    mistakes: list[str] = []
    plain = (*PLAIN_ROLES, *other_roles, *rates)
    for part in (text or "").split(","):
        entry = part.strip()
        if not entry:
            continue
        role, equals, address = (piece.strip() for piece in entry.partition("="))
        address, unit = _parted(address)
        kind = "gyro" if role in rates else role
        mistake = _mistake(role, equals, address, n_joint, plain) or _misfit(role, dimensions_of(kind), unit)
        if not mistake and role in entries:
            mistake = f"role {role!r} is given twice, expected once"
        if mistake:
            mistakes.append(f"--columns, entry {entry!r}: {mistake}")
        entries[role] = address
        if unit is not None:
            units[role] = unit
    if mistakes:
        raise ConfigError(mistakes)
    return ColumnMap(entries, units, rates)


def dimensions_of(role: str) -> tuple[str, ...]:
    """Return what the columns of a role, with or without a joint's number, can measure."""
    numbered = _NUMBERED.fullmatch(role)
    if numbered:
        return DIMENSIONS.get(numbered[1], ())
    if role in ("trial", *DRIVE_ROLES, *BASE_QUATERNION):
        return ()
    return DIMENSIONS.get(role) or DIMENSIONS["tip" if role in (*TIP_ROLES, *BASE_PLACE) else "a"]


def _parted(address: str) -> tuple[str, Unit | None]:
    """Part an address from the unit behind its last colon, if one stands there."""
    name, colon, text = address.rpartition(":")
    unit = parse_unit(text) if colon else None
    return (address, None) if unit is None else (name.strip(), unit)


def _misfit(role: str, dimensions: tuple[str, ...], unit: Unit | None) -> str:
    """Say that a role of some dimensions cannot be in a unit, or nothing."""
    if unit is None or unit.dimension in dimensions:
        return ""
    if role == "trial":
        return "trial is a name and has no unit"
    if not dimensions:
        return f"{role} has no such unit, expected a number in SI; a factor may stand in the address"
    return f"{role} cannot be in {unit.name}, expected one of {known_units(dimensions)}"


def _mistake(role: str, equals: str, address: str, n_joint: int, plain: Sequence[str]) -> str:
    """Say what is wrong with one entry, or nothing."""
    numbered = _NUMBERED.fullmatch(role)
    if not equals:
        return "there is no '=', expected role=column"
    if role not in plain and role not in JOINT_ROLES and not numbered:
        return f"{role!r} is no role, expected one of {', '.join((*JOINT_ROLES, *plain))}"
    if numbered and int(numbered[2]) > n_joint:
        return f"role {role!r} is of joint {numbered[2]}, expected 1 to {n_joint} as the arm has"
    return _misplaced_joint(role, address, n_joint)


def _misplaced_joint(role: str, address: str, n_joint: int) -> str:
    has_joint = bool(_PLACEHOLDER.search(address))
    shared = role in DRIVE_ROLES
    if role in JOINT_ROLES and address and not has_joint and n_joint > 1 and not shared:
        return f"{address!r} has no {{j}}, expected the place of the joint's number in it"
    if has_joint and role not in JOINT_ROLES:
        return f"{{j}} in {address!r}, expected it only in the roles {', '.join(JOINT_ROLES)}"
    if "{" in _PLACEHOLDER.sub("", address):
        return f"{address!r} has braces other than {{j}} and {{j+1}}"
    return ""


def _count(found: re.Match[str], number: int) -> str:
    shift = int(found[2] or 0)
    return str(number - shift if found[1] == "-" else number + shift)
