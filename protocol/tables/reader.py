"""The one reader of tables: every command reads joint motion and raw readings by it, whole or block by block."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.columns import JOINT_ROLES, Address, ColumnMap, dimensions_of
from protocol.tables.files import open_source
from protocol.tables.roles import Plan, find_roles, no_column
from protocol.tables.source import Rows, Source
from protocol.tables.switches import require_switches
from protocol.tables.table import Table


def read_tables(
    path: Path,
    n_joint: int,
    mapping: ColumnMap,
    required: Collection[str],
    *,
    vectors: Mapping[str, Sequence[str]] | None = None,
    joint_roles: Sequence[str] = JOINT_ROLES,
    rate_hz: float | None = None,
) -> list[Table]:
    """Read a file of columns whole.

    Parameters
    ----------
    path : Path
        CSV, Parquet, NPZ, ``.mat``, ``.json`` or ``.jsonl``.
    n_joint : int
        Number of joints of the arm.
    mapping : ColumnMap
        Which column plays which role.
    required : collection of str
        Roles that must be there; others are taken where they are. Columns without a role are never read.
    vectors : mapping of str to sequence of str, optional
        Roles of several plain columns, such as ``{"tip": ("tipx", "tipy", "tipz")}``.
    joint_roles : sequence of str, optional
        Roles with a column a joint that are wanted.
    rate_hz : float, optional
        Rate of the samples where the file has no time.

    Returns
    -------
    list of Table
        One, or one a cell of a ``.mat``; ``t`` has shape (n, 1). The notes are those of the file, on the first.

    Raises
    ------
    DataError
        If a column is missing or does not fit, a drive is neither engaged nor let go, or there is no row.
    """
    source = open_source(path)
    plan = find_roles(source, n_joint, mapping, required, vectors or {}, joint_roles)
    _require_time(source, plan, rate_hz)
    tables: list[Table] = []
    for rows in source.read(plan.columns, plan.label):
        tables.append(_table(rows, plan, 0, rate_hz, str(path)))
    if not all(len(table.groups["t"]) for table in tables):
        raise DataError(f"{path}: there is a header but no row, expected samples")
    notes = (*source.notes, *plan.notes, *_clock_notes(source, plan))
    return [_noted(table, plan, notes if k == 0 else ()) for k, table in enumerate(tables)]


def read_table_blocks(
    path: Path, n_joint: int, mapping: ColumnMap, required: Collection[str], rate_hz: float | None, rows: int
) -> Iterator[Table]:
    """Read the same files in blocks of about `rows` rows, in the order of the file and in bounded memory.

    Parameters are those of `read_tables`. Files that are no streams (``.mat``, ``.json``, NPZ files of tables)
    come whole, one block a cell.
    """
    source = open_source(path)
    plan = find_roles(source, n_joint, mapping, required, {})
    _require_time(source, plan, rate_hz)
    if not source.streams(plan.columns, plan.label):
        yield from read_tables(path, n_joint, mapping, required, rate_hz=rate_hz)
        return
    first = 0
    for part in source.blocks(plan.columns, plan.label, rows):
        table = _table(part, plan, first, rate_hz, str(path))
        n = len(table.groups["t"])
        if n:
            notes = () if first else (*source.notes, *plan.notes, *_clock_notes(source, plan))
            yield _noted(table, plan, notes)
        first += n
    if not first:
        raise DataError(f"{path}: there is a header but no row, expected samples")


def _require_time(source: Source, plan: Plan, rate_hz: float | None) -> None:
    if "t" not in plan.columns and plan.step_s is None and rate_hz is None:
        expected = ", expected time stamps, or else the rate of the samples"
        raise no_column(source, Address("t", "t", asked=False, dimensions=dimensions_of("t")), expected=expected)


def _table(rows: Rows, plan: Plan, first: int, rate_hz: float | None, where: str) -> Table:
    groups = dict(rows.groups)
    n = len(next(iter(groups.values())))
    groups |= {role: sums.of(groups.get(role, np.empty((n, 0)))) for role, sums in plan.sums.items()}
    if "t" not in groups:
        counted = np.arange(first, first + n, dtype=np.float64)[:, None]
        groups["t"] = counted / (rate_hz or 1.0) if plan.step_s is None else plan.step_s * counted
    if "on" in groups:
        require_switches(groups["on"], where, first)
    return Table(groups, plan.names, rows.labels, first_row=first)


def _noted(table: Table, plan: Plan, notes: tuple[Note, ...]) -> Table:
    stated = frozenset(plan.stated)
    clock = plan.columns["t"][0].clock if "t" in plan.columns else None
    if plan.step_s is not None or (clock is not None and (clock.unit or clock.factor is not None)):
        stated |= {"t"}
    origin_s = 0.0 if clock is None else clock.origin_s
    return Table(table.groups, table.names, table.labels, stated, table.first_row, notes, origin_s)


def _clock_notes(source: Source, plan: Plan) -> list[Note]:
    """Say what was done to stamps that count from 1970, or are dates."""
    if "t" not in plan.columns:
        return []
    (column,) = plan.columns["t"]
    clock, path = column.clock, str(source.path)
    notes: list[Note] = []
    if clock is not None and clock.unit:
        since = " since 1970" if clock.since_1970 else ""
        text = f"{column.address} counts {clock.unit}{since}, by its size, and is converted to s"
        notes.append(Note("unit", text, source=path, columns=(column.address,)))
    if clock is not None and clock.origin:
        text = f"{column.address} is counted from the file's first stamp, {clock.origin_s:.6f} s"
        notes.append(Note("clock", text, source=path, columns=(column.address,)))
    return notes
