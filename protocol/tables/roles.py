"""Which columns of a file play which role, and in which units they are."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.clock import Clock
from protocol.tables.columns import BASE_ROLES, DRIVE_ROLES, JOINT_ROLES, Address, ColumnMap, dimensions_of
from protocol.tables.source import Column, Source
from protocol.tables.sums import ColumnSum, RoleSums, parse_sum, role_sums
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
#: What may be one number for all of a motion.
_MAY_BE_CONSTANT = ("dq", "ddq", "tau", "ref", *DRIVE_ROLES)
#: Columns that look like a drive's and are not called so: `kp1 [N.m/rad]`.
_LIKE_DRIVE = re.compile(rf"({'|'.join(DRIVE_ROLES)})[1-9]\d*\W.*")


@dataclass
class Plan:
    """What is to be read of a file.

    Attributes
    ----------
    columns : dict of str to list of Column
        By role, what is read of the file: ``t`` with one, others with one a joint or axis, unless they are sums.
    names : dict of str to list of str
        By role, what the file calls each joint's or axis' column, or how the mapping writes its sum.
    sums : dict of str to RoleSums
        By role, what becomes of the columns that are read, where that is not these themselves.
    step_s : float or None
        Step of the samples [s], where the mapping gives that in the place of time stamps.
    label : str or None
        Address of the ``trial`` column.
    stated : set of str
        Canonical names of columns whose unit somebody states.
    notes : list of Note
        Units that were heeded, and columns that mean something and are not read.
    """

    columns: dict[str, list[Column]] = field(default_factory=dict)
    names: dict[str, list[str]] = field(default_factory=dict)
    sums: dict[str, RoleSums] = field(default_factory=dict)
    step_s: float | None = None
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
    _require_all_read(source, mapping, joint_roles, {name for names in vectors.values() for name in names})
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
            plan.label = _label(source, found, plan)
        elif role == "t" and found and not found[0][1].terms:
            plan.step_s = _step(source, found[0])
        elif found and not _blank(source, role, found, role in required, plan):
            _take(source, role, found, plan)
        elif role in required:
            raise DataError(f"{source.path}: nothing is mapped to {role!r}, which is needed")
    for role in joint_roles:
        extra = mapping.joint(role, n_joint + 1)
        if role in plan.names and mapping.numbers_joints(role) and extra is not None:
            if (more := source.match(extra.text, dimensions_of(role + "1"))) in source.names and more is not None:
                arm = f"{n_joint} joint{'' if n_joint == 1 else 's'}"
                raise DataError(f"{source.path}: there is a column {more!r}, but the arm has {arm}")
    taken = {column.address for columns in plan.columns.values() for column in columns}
    passed_over = tuple(
        name
        for name in source.names
        if name not in taken and (name in BASE_ROLES or (joint_roles and _LIKE_DRIVE.fullmatch(name)))
    )
    if passed_over:
        text = f"column {', '.join(passed_over)} {'is' if len(passed_over) == 1 else 'are'} not used here"
        plan.notes.append(Note("unused", text, source=str(source.path), columns=passed_over))
    return plan


def listed(source: Source) -> str:
    """Return the names of a file's columns in words."""
    return "its columns " + ", ".join(source.names) if source.names else "its columns (there are none)"


def no_column(source: Source, address: Address, beside: str = "", expected: str = "") -> DataError:
    """Return the error that a column is not there, with the name or the unit that may have been meant."""
    dimensions = address.dimensions
    name, colon, unit = address.text.rpartition(":")
    if colon and source.match(name, dimensions) is not None:
        hint = f"; {unit!r} is no unit that is known, expected one of {known_units(dimensions)}"
    else:
        nearest = source.nearest(address.text)
        hint = f"; did you mean {nearest!r}?" if nearest else ""
    return DataError(f"{source.path}: no column {address.text!r}{beside} among {listed(source)}{expected}{hint}")


Found = tuple[Address, ColumnSum]


def _require_all_read(
    source: Source, mapping: ColumnMap, joint_roles: Sequence[str], plain: Collection[str]
) -> None:
    """Raise a DataError where a drive or a base is mapped for a command that asks nothing of it."""
    for role in mapping.entries:
        name = role.rstrip("0123456789")
        what = "the drive" if name in DRIVE_ROLES and name not in joint_roles else ""
        what = "the base's pose" if name in BASE_ROLES and name not in plain else what
        if what and mapping.entries[role]:
            raise DataError(f"{source.path}: {role!r} is mapped, but this command does not ask for {what}")


def _present(source: Source, addresses: Sequence[Address], required: bool) -> list[Found]:
    """Return the columns if all of them are there; if one is, none may be missing."""
    matched = [(address, _sum_of(source, address)) for address in addresses]
    here = [(address, found) for address, found in matched if found is not None]
    missing = [address for address, found in matched if found is None]
    if missing and (here or required or missing[0].asked):
        beside = f" beside {', '.join(_written(one) for one in here)}" if here else ""
        raise no_column(source, missing[0], beside)
    return here


def _sum_of(source: Source, address: Address) -> ColumnSum | None:
    """Return the column at an address, or the sum that is written there, by the file's own names."""
    dimensions = address.dimensions
    whole = source.match(address.text, dimensions)
    written = parse_sum(address.text) if address.asked else None
    if written is not None and written.is_plain and whole not in source.names:
        whole = source.match(written.terms[0][0], dimensions)
    if written is None or written.is_plain or whole in source.names:  # a name may have a sign in it
        return None if whole is None else ColumnSum(((whole, 1.0),))
    terms = []
    for name, factor in written.terms:
        found = source.match(name, dimensions)
        if found is None:
            raise no_column(source, replace(address, text=name, asked=True))
        terms.append((found, factor))
    if not terms and address.role != "t" and address.role.rstrip("0123456789") not in _MAY_BE_CONSTANT:
        raise DataError(f"{source.path}: {address.role} is mapped to {address.text!r}, expected a column")
    return ColumnSum(tuple(terms), written.constant)


def _written(found: Found) -> str:
    """Return how a column is called, or its sum written."""
    address, total = found
    return total.terms[0][0] if total.is_plain else address.text


def _label(source: Source, found: Sequence[Found], plan: Plan) -> str | None:
    """Return the column of trials' names."""
    if not found or _blank(source, "trial", found, False, plan):
        return None
    ((address, total),) = found
    if not total.is_plain:
        raise DataError(f"{source.path}: trial is mapped to {address.text!r}, expected a column")
    return total.terms[0][0]


def _step(source: Source, found: Found) -> float:
    """Return the step [s] that stands in the place of time stamps."""
    address, total = found
    step_s = total.constant * (1.0 if address.unit is None else address.unit.factor)
    if not step_s > 0.0:
        raise DataError(f"{source.path}: t is mapped to {address.text!r}, expected a column, or a step above 0 s")
    return step_s


def _time(source: Source, address: Address, plan: Plan) -> list[Found]:
    """Return the column of time stamps if it goes by another usual name."""
    for name in _TIMES:
        match = source.match(name, dimensions_of("t"))
        if match is not None and match in source.names:
            plan.notes.append(
                Note("column", f"column {match!r} is taken for 't'", source=str(source.path), columns=(match,))
            )
            return [(address, ColumnSum(((match, 1.0),)))]
    return []


def _blank(source: Source, role: str, found: Sequence[Found], required: bool, plan: Plan) -> bool:
    """Say whether columns that nobody asked for by name have no value in them; they are as good as not there."""
    if required or role == "t" or found[0][0].asked:
        return False
    names = tuple(total.terms[0][0] for _, total in found)
    if not all(source.is_blank(name) for name in names):
        return False
    text = f"{', '.join(names)}: there is a header and no value, so {role} counts as not given"
    plan.notes.append(Note("empty", text, source=str(source.path), columns=names))
    return True


def _take(source: Source, role: str, found: Sequence[Found], plan: Plan) -> None:
    """Put the columns of a role into the plan with what makes SI of them, and note the units that are heeded."""
    columns: list[Column] = []
    sums: list[ColumnSum] = []
    heeded: dict[Unit, list[str]] = {}
    beside: dict[Unit, list[str]] = {}
    dimensions = dimensions_of(role)
    for address, total in found:
        for name, _ in total.terms:
            unit = address.unit or (source.unit(name, address.dimensions) if dimensions else None)
            if unit is not None:
                plan.stated.add(address.role)
                if unit.factor != 1.0:
                    heeded.setdefault(unit, []).append(name)
                    if total.constant and address.unit is None:
                        beside.setdefault(unit, []).append(address.text)
            factor = None if unit is None else unit.factor
            if role == "t":
                columns.append(Column(name, 1.0, Clock(_tick(source, address, total, factor))))
            else:
                columns.append(Column(name, factor or 1.0, per_file=role in DRIVE_ROLES))
        sums.append(ColumnSum(total.terms, total.constant * (address.unit.factor if address.unit else 1.0)))
    plan.names[role] = [_written(one) for one in found]
    if columns:
        plan.columns[role] = columns
    if role != "t" and not all(total.is_plain for total in sums):
        plan.sums[role] = role_sums(sums)
    for unit, names in heeded.items():
        verb = "is" if len(names) == 1 else "are"
        text = f"{', '.join(names)} {verb} in {unit.name} and {verb} converted to {_SI[unit.dimension]}"
        plan.notes.append(Note("unit", text, source=str(source.path), columns=tuple(names)))
    for unit, texts in beside.items():
        text = (
            f"the number in {', '.join(dict.fromkeys(texts))} is taken in {_SI[unit.dimension]}, beside a column "
            f"in {unit.name}; if it is in {unit.name}, expected ':{unit.name}' behind it in the mapping"
        )
        plan.notes.append(Note("unit", text, source=str(source.path), columns=tuple(heeded[unit])))


def _tick(source: Source, address: Address, total: ColumnSum, factor: float | None) -> float | None:
    """Return the length of a unit of time stamps [s], a factor in the mapping included; None if nobody says it."""
    if total.constant != 0.0 or len(total.terms) != 1 or not total.terms[0][1] > 0.0:
        raise DataError(
            f"{source.path}: t is mapped to {address.text!r}, expected a column, if need be times a number above 0"
        )
    return factor if total.is_plain else total.terms[0][1] * (factor or 1.0)
