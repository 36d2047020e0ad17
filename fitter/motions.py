"""Motions as they were measured: columns by role, on whatever time stamps they came with."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fitter.columns import JOINT_ROLES, TIP_ROLES, Address, ColumnMap
from fitter.sources import open_source
from fitter.tables import Columns, Floats, Source, Texts
from limbcal.errors import DataError


@dataclass(frozen=True)
class Measured:
    """One motion as a file holds it.

    Attributes
    ----------
    name : str
        What to call it: the file's stem, and the trial or cell where there are several in it.
    where : str
        The file, for errors.
    first_row : int
        How many data rows of the file come before it.
    t : ndarray of shape (n,)
        Time stamps [s], rising, as in the file.
    columns : mapping of str to ndarray of shape (n, …)
        By role: q, dq, ddq, tau, ref with one column a joint, tip with three.
    role : str, optional
        "learn" or "evaluate", where a recording says so.
    notes : tuple of str
        What was done to it so far.
    """

    name: str
    where: str
    first_row: int
    t: Floats
    columns: Mapping[str, Floats]
    role: str | None = None
    notes: tuple[str, ...] = field(default=())

    def rows(self, begin: int, end: int, name: str, *notes: str) -> "Measured":
        """Return a stretch of it as a motion of its own."""
        return Measured(
            name,
            self.where,
            self.first_row + begin,
            self.t[begin:end],
            {role: values[begin:end] for role, values in self.columns.items()},
            self.role,
            (*self.notes, *notes),
        )


def read_motions(
    path: Path, n_joint: int, mapping: ColumnMap, rate_hz: float | None, required: Collection[str]
) -> list[Measured]:
    """Read every motion of a CSV, Parquet, NPZ, ``.mat`` or ``.json`` file.

    Parameters
    ----------
    path : Path
        The file.
    n_joint : int
        Number of joints of the arm.
    mapping : ColumnMap
        Which column plays which role.
    rate_hz : float or None
        Rate of the samples where the file has no time.
    required : collection of str
        Roles that must be there; others are taken where they are.

    Raises
    ------
    DataError
        If a column is missing or does not fit, or time does not rise within a motion.
    """
    source = open_source(path)
    roles = _find_roles(source, n_joint, mapping, required)
    time = mapping.plain("t")
    time = time if time is not None and _is_there(source, time) else None
    if time is None and rate_hz is None:
        raise DataError(
            f"{path}: no column 't' among {_listed(source)}, expected time stamps, or else the rate of the samples"
        )
    label = mapping.plain("trial")
    label = label if label is not None and _is_there(source, label) else None

    wanted = [address for addresses in roles.values() for address in addresses]
    wanted += [address.text for address in (time, label) if address is not None]
    motions: list[Measured] = []
    tables = source.read(list(dict.fromkeys(wanted)), () if label is None else (label.text,))
    for cell, table in enumerate(tables):
        n = len(table[wanted[0]])
        stamps = _floats(table, time.text) if time else np.arange(n) / (rate_hz or 1.0)
        columns = {
            role: np.column_stack([_floats(table, address) for address in addresses])
            for role, addresses in roles.items()
        }
        name = path.stem if len(tables) == 1 else f"{path.stem}({cell + 1})"
        whole = Measured(name, str(path), 0, stamps, columns)
        motions += _by_label(whole, None if label is None else np.asarray(table[label.text], dtype=np.str_))
    for motion in motions:
        require_rising(motion)
    return motions


def require_rising(motion: Measured) -> None:
    """Raise a DataError where time stands still or runs backwards."""
    steps = np.diff(motion.t)
    if len(steps) and not (steps > 0.0).all():
        k = int(np.argmin(steps > 0.0))
        said = "stands still at" if steps[k] == 0.0 else f"runs backwards from {motion.t[k]:.9g} s to"
        raise DataError(
            f"{motion.where}: in row {motion.first_row + k + 2} time {said} {motion.t[k + 1]:.9g} s, "
            "expected it to rise until a column 'trial' says that another trial begins"
        )


def _find_roles(
    source: Source, n_joint: int, mapping: ColumnMap, required: Collection[str]
) -> dict[str, list[str]]:
    """Return the addresses of every role that the file has, joint by joint."""
    roles: dict[str, list[str]] = {}
    for role in JOINT_ROLES:
        addresses = [mapping.joint(role, number) for number in range(1, n_joint + 1)]
        asked = [address for address in addresses if address is not None]
        found = _present(source, asked, role in required) if len(asked) == n_joint else []
        if not found:
            continue
        roles[role] = found
        extra = mapping.joint(role, n_joint + 1)
        counted = mapping.numbers_joints(role) and "[" not in found[0]
        if counted and extra is not None and extra.text not in found and source.has(extra.text):
            raise DataError(f"{source.path}: there is a column {extra.text!r}, but the arm has {_joints(n_joint)}")
    tip = _present(source, [a for a in map(mapping.plain, TIP_ROLES) if a is not None], required=False)
    if tip:
        roles["tip"] = tip
    missing = [role for role in required if role not in roles]
    if missing:
        raise DataError(f"{source.path}: nothing is mapped to {', '.join(missing)}, which is needed")
    return roles


def _present(source: Source, addresses: Sequence[Address], required: bool) -> list[str]:
    """Return the addresses if all of them are there; none of them may be missing if one is there."""
    here = [address.text for address in addresses if _is_there(source, address)]
    if len(here) < len(addresses) and (here or required):
        missing = next(address.text for address in addresses if address.text not in here)
        beside = f" beside {', '.join(here)}" if here else ""
        raise DataError(f"{source.path}: no column {missing!r}{beside} among {_listed(source)}")
    return here


def _is_there(source: Source, address: Address) -> bool:
    if source.has(address.text):
        return True
    if address.asked:
        raise DataError(f"{source.path}: no column {address.text!r} among {_listed(source)}")
    return False


def _listed(source: Source) -> str:
    return "its columns " + ", ".join(source.names) if source.names else "its columns (there are none)"


def _joints(n_joint: int) -> str:
    return f"{n_joint} joint{'' if n_joint == 1 else 's'}"


def _floats(table: Columns, address: str) -> Floats:
    return np.asarray(table[address], dtype=np.float64)


def _by_label(whole: Measured, labels: Texts | None) -> list[Measured]:
    """Part a file by its ``trial`` column; each trial must stand in one piece."""
    if labels is None or not len(labels):
        return [whole]
    bounds = [0, *(np.flatnonzero(labels[1:] != labels[:-1]) + 1).tolist(), len(labels)]
    seen: set[str] = set()
    trials: list[Measured] = []
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        label = str(labels[begin])
        if label in seen:
            raise DataError(
                f"{whole.where}: trial {label!r} goes on in row {whole.first_row + begin + 1} after another one, "
                "expected each trial in one piece"
            )
        seen.add(label)
        trials.append(whole.rows(begin, end, f"{whole.name}/{label}"))
    return trials
