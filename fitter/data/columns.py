"""Which column of a foreign file plays which role: ``"t=time,q=pos_meas{j},tau=tau_meas{j}"``."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from limbcal.errors import ConfigError

#: Roles that have one column a joint; ``q`` stands for q1 … qn, ``q2`` for one of them.
JOINT_ROLES = ("q", "dq", "ddq", "tau", "ref")
TIP_ROLES = ("tipx", "tipy", "tipz")
PLAIN_ROLES = ("t", "trial", *TIP_ROLES)

_PLACEHOLDER = re.compile(r"\{j(?:([+-])(\d+))?\}")
_NUMBERED = re.compile(rf"({'|'.join(JOINT_ROLES)})([1-9]\d*)")


@dataclass(frozen=True)
class Address:
    """Where a role is found: the name of a column, or the way to an array in a ``.mat`` or ``.json``.

    ``asked`` tells a column that the mapping named, and that must therefore be there, from one that is only
    looked for by its own name.
    """

    text: str
    asked: bool


@dataclass(frozen=True)
class ColumnMap:
    """Roles and the addresses that a mapping gave them; whatever it leaves out goes by its own name."""

    entries: Mapping[str, str] = field(default_factory=dict)

    def plain(self, role: str) -> Address | None:
        """Return where a role without a joint number is found, or None if it was mapped to nothing."""
        if role not in self.entries:
            return Address(role, asked=False)
        text = self.entries[role]
        return Address(text, asked=True) if text else None

    def joint(self, role: str, number: int) -> Address | None:
        """Return where a role of one joint (counted from 1) is found, or None if it was mapped to nothing."""
        own = f"{role}{number}"
        if own in self.entries:
            return self.plain(own)
        if role not in self.entries:
            return Address(own, asked=False)
        text = self.entries[role]
        return Address(_PLACEHOLDER.sub(lambda found: _count(found, number), text), asked=True) if text else None

    def numbers_joints(self, role: str) -> bool:
        """Say whether the number of a role's columns follows from the file, not from the mapping."""
        return role not in self.entries or bool(_PLACEHOLDER.search(self.entries[role]))


def parse_mapping(text: str | None, n_joint: int, other_roles: Sequence[str] = ()) -> ColumnMap:
    """Read a mapping of roles to foreign columns.

    Parameters
    ----------
    text : str or None
        Entries ``role=address`` parted by commas. Roles are ``t``, ``trial``, ``tipx tipy tipz`` and, with one
        column a joint, ``q dq ddq tau ref``: there ``{j}`` in the address stands for the joint's number from
        1, ``{j+2}`` for the number plus two, and single joints can be named (``q1=shoulder,q2=elbow``). An empty
        address (``dq=``) leaves a column that is there unused. None: every column goes by its own name.
    n_joint : int
        Number of joints of the arm.
    other_roles : sequence of str, optional
        Further plain roles, such as the axes of accelerometers.

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
    mistakes: list[str] = []
    plain = (*PLAIN_ROLES, *other_roles)
    for part in (text or "").split(","):
        entry = part.strip()
        if not entry:
            continue
        role, equals, address = (piece.strip() for piece in entry.partition("="))
        mistake = _mistake(role, equals, address, n_joint, plain)
        if not mistake and role in entries:
            mistake = f"role {role!r} is given twice, expected once"
        if mistake:
            mistakes.append(f"--columns, entry {entry!r}: {mistake}")
        entries[role] = address
    if mistakes:
        raise ConfigError(mistakes)
    return ColumnMap(entries)


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
    if role in JOINT_ROLES and address and not has_joint and n_joint > 1:
        return f"{address!r} has no {{j}}, expected the place of the joint's number in it"
    if has_joint and role not in JOINT_ROLES:
        return f"{{j}} in {address!r}, expected it only in the roles {', '.join(JOINT_ROLES)}"
    if "{" in _PLACEHOLDER.sub("", address):
        return f"{address!r} has braces other than {{j}} and {{j+1}}"
    return ""


def _count(found: re.Match[str], number: int) -> str:
    shift = int(found[2] or 0)
    return str(number - shift if found[1] == "-" else number + shift)
