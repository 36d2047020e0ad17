"""Which columns of a file play which role, and in which units they are."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.clock import Clock
from protocol.tables.columns import JOINT_ROLES, NOT_READ, Address, ColumnMap, dimensions_of
from protocol.tables.source import Column, Source
from protocol.tables.units import Unit, known_units

#: What time stamps are often called; taken for ``t`` where there is no column of that name.
_TIMES = ("time", "timestamp", "Time", "Timestamp", "TIME", "T")
_SI = {
    "time": "s",
    "angle": "rad",
    "length": "m",
    "angular velocity": "rad/s",
    "velocity": "m/s",
    "angular acceleration": "rad/s2",
    "acceleration": "m/s2",
    "torque": "N.m",
    "force": "N",
}


@dataclass
class Plan:
    """What is to be read of a file.

    Attributes
    ----------
    columns : dict of str to list of Column
        By role: ``t`` with one, q, dq, ddq, tau and ref with one a joint, and vectors.
    label : str or None
        Address of the ``trial`` column.
    stated : set of str
        Canonical names of columns whose unit somebody states.
    notes : list of Note
        Units that were heeded, and columns that mean something and are not read.
    """

    columns: dict[str, list[Column]] = field(default_factory=dict)
    label: str | None = None
    stated: set[str] = field(default_factory=set)
    notes: list[Note] = field(default_factory=list)


def find_roles(
    source: Source,
    n_joint: int,
    mapping: ColumnMap,
    required: Collection[str],
    vectors: Mapping[str, Sequence[str]],
    joint_roles: Sequence[str] = JOINT_ROLES,
) -> Plan:
    """Return the columns of every role that a file has.

    Parameters
    ----------
    source : Source
        The opened file.
    n_joint : int
        Number of joints of the arm.
    mapping : ColumnMap
        What the user said of the columns.
    required : collection of str
        Roles that must be there.
    vectors : mapping of str to sequence of str
        Roles of several plain columns, such as ``{"tip": ("tipx", "tipy", "tipz")}``.
    joint_roles : sequence of str, optional
        Which roles with a column a joint are wanted; others are not looked at.

    Raises
    ------
    DataError
        If a column that was asked for is not there, some columns of a role are missing, a unit does not fit, or
        there are more joints than the arm has.
    """
    wanted: dict[str, list[Address | None]] = {name: [mapping.plain(name)] for name in ("t", "trial")}
    wanted |= {role: [mapping.joint(role, number) for number in range(1, n_joint + 1)] for role in joint_roles}
    wanted |= {role: [mapping.plain(name) for name in names] for role, names in vectors.items()}
    plan = Plan()
    for role, addresses in wanted.items():
        asked = [address for address in addresses if address is not None]
        found = _present(source, asked, role in required) if len(asked) == len(addresses) else []
        if role == "t" and not found and asked and not asked[0].asked:
            found = _time(source, asked[0], plan)
        if role == "trial":
            plan.label = found[0][1] if found and not _blank(source, role, found, False, plan) else None
        elif found and not _blank(source, role, found, role in required, plan):
            plan.columns[role] = _columns(source, role, found, plan)
        elif role in required:
            raise DataError(f"{source.path}: nothing is mapped to {role!r}, which is needed")
    for role in joint_roles:
        extra = mapping.joint(role, n_joint + 1)
        if role in plan.columns and mapping.numbers_joints(role) and extra is not None:
            if (more := source.match(extra.text, dimensions_of(role + "1"))) in source.names and more is not None:
                arm = f"{n_joint} joint{'' if n_joint == 1 else 's'}"
                raise DataError(f"{source.path}: there is a column {more!r}, but the arm has {arm}")
    passed_over = tuple(name for name in source.names if NOT_READ.fullmatch(name))
    if passed_over:
        text = f"column {', '.join(passed_over)} {'is' if len(passed_over) == 1 else 'are'} not read yet"
        plan.notes.append(Note("unused", text, source=str(source.path), columns=passed_over))
    return plan


def listed(source: Source) -> str:
    """Return the names of a file's columns in words."""
    return "its columns " + ", ".join(source.names) if source.names else "its columns (there are none)"


def no_column(source: Source, address: Address, beside: str = "", expected: str = "") -> DataError:
    """Return the error that a column is not there, with the name or the unit that may have been meant."""
    dimensions = dimensions_of(address.role)
    name, colon, unit = address.text.rpartition(":")
    if colon and source.match(name, dimensions) is not None:
        hint = f"; {unit!r} is no unit that is known, expected one of {known_units(dimensions)}"
    else:
        nearest = source.nearest(address.text)
        hint = f"; did you mean {nearest!r}?" if nearest else ""
    return DataError(f"{source.path}: no column {address.text!r}{beside} among {listed(source)}{expected}{hint}")


Found = tuple[Address, str]


def _present(source: Source, addresses: Sequence[Address], required: bool) -> list[Found]:
    """Return the columns if all of them are there; if one is, none may be missing."""
    matched = [(address, source.match(address.text, dimensions_of(address.role))) for address in addresses]
    here = [(address, name) for address, name in matched if name is not None]
    missing = [address for address, name in matched if name is None]
    if missing and (here or required or missing[0].asked):
        beside = f" beside {', '.join(name for _, name in here)}" if here else ""
        raise no_column(source, missing[0], beside)
    return here


def _time(source: Source, address: Address, plan: Plan) -> list[Found]:
    """Return the column of time stamps if it goes by another usual name."""
    for name in _TIMES:
        match = source.match(name, dimensions_of("t"))
        if match is not None and match in source.names:
            plan.notes.append(
                Note("column", f"column {match!r} is taken for 't'", source=str(source.path), columns=(match,))
            )
            return [(address, match)]
    return []


def _blank(source: Source, role: str, found: Sequence[Found], required: bool, plan: Plan) -> bool:
    """Say whether columns that nobody asked for by name have no value in them; they are as good as not there."""
    if required or role == "t" or found[0][0].asked or not all(source.is_blank(name) for _, name in found):
        return False
    names = tuple(name for _, name in found)
    text = f"{', '.join(names)}: there is a header and no value, so {role} counts as not given"
    plan.notes.append(Note("empty", text, source=str(source.path), columns=names))
    return True


def _columns(source: Source, role: str, found: Sequence[Found], plan: Plan) -> list[Column]:
    """Return the columns of a role with what makes SI of them, and note the units that are heeded."""
    columns: list[Column] = []
    heeded: dict[Unit, list[str]] = {}
    for address, name in found:
        unit = address.unit or source.unit(name, dimensions_of(address.role))
        if unit is not None:
            plan.stated.add(address.role)
            if unit.factor != 1.0:
                heeded.setdefault(unit, []).append(name)
        factor = None if unit is None else unit.factor
        columns.append(Column(name, 1.0, Clock(factor)) if role == "t" else Column(name, factor or 1.0))
    for unit, names in heeded.items():
        verb = "is" if len(names) == 1 else "are"
        text = f"{', '.join(names)} {verb} in {unit.name} and {verb} converted to {_SI[unit.dimension]}"
        plan.notes.append(Note("unit", text, source=str(source.path), columns=tuple(names)))
    return columns
