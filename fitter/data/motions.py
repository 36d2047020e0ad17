"""Motions as they were measured: columns by role, on whatever time stamps they came with."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.effects.trials import TrialId, trial_id
from fitter.data.felt import Felt
from limbcal.note import Note
from protocol.tables import stamps
from protocol.tables.columns import JOINT_ROLES, TIP_ROLES, ColumnMap
from protocol.tables.reader import read_tables
from protocol.tables.table import Table
from tracking.model.draws import Draws

Floats = NDArray[np.float64]
Labels = NDArray[np.str_]

TIP = {"tip": TIP_ROLES}


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
        Time stamps [s], as in the file.
    columns : mapping of str to ndarray of shape (n, …)
        By role: q, dq, ddq, tau, ref, on, kp, kv with one column a joint, tip with three.
    role : str, optional
        "learn" or "evaluate", where a recording says so.
    notes : tuple of Note
        What was found in it and done to it so far.
    labels : ndarray of str, shape (n,), or None
        The ``trial`` column.
    stated : frozenset of str
        Columns (``t``, ``q1``, ``tau2``, ``tipx`` …) whose unit the file or the mapping states, in a header, a row
        of units, a type or an entry of ``--columns``: a magnitude that surprises is no question of units there.
    felt : Felt or None
        What the sensors read from the rest before it to the rest after it, where that came along.
    piece_of : str
        The name of the trial that it is a piece of, if that was parted.
    draws : Draws or None
        The motion as it may have been, where its tracker says so.
    target_std : (n_joint,) [N m or N], or None
        Where nobody recorded ``ref`` and it is the target that a calibrated arm explains the motion with: standard
        deviation of the constant torque by which it is off, taken to be that of what varies beside it.
    """

    name: str
    where: str
    first_row: int
    t: Floats
    columns: Mapping[str, Floats]
    role: str | None = None
    notes: tuple[Note, ...] = ()
    labels: Labels | None = None
    stated: frozenset[str] = frozenset()
    felt: Felt | None = None
    piece_of: str = ""
    draws: Draws | None = None
    target_std: Floats | None = None

    @property
    def label(self) -> str:
        """What stands in its ``trial`` column; nothing without one."""
        return "" if self.labels is None or not len(self.labels) else str(self.labels[0])

    def identity(self, place: int) -> TrialId:
        """Return what effects call it, at its place in the run: a piece is called as its trial is."""
        return trial_id(place, self.label, self.piece_of or self.name)

    def rows(self, begin: int, end: int, name: str, *notes: Note) -> "Measured":
        """Return a stretch of it as a motion of its own."""
        return Measured(
            name,
            self.where,
            self.first_row + begin,
            self.t[begin:end],
            {role: values[begin:end] for role, values in self.columns.items()},
            self.role,
            (*self.notes, *notes),
            None if self.labels is None else self.labels[begin:end],
            self.stated,
            draws=None if self.draws is None else self.draws.rows(slice(begin, end)),
            target_std=self.target_std,
        )

    def piece(self, begin: int, end: int, k: int, *notes: Note) -> "Measured":
        """Return a stretch of it as its k-th piece, from 1."""
        part = self.rows(begin, end, f"{self.name}#{k}", *notes)
        return replace(part, piece_of=self.piece_of or self.name)


def trial_column(trials: Sequence[Measured]) -> list[int] | list[str]:
    """Return what stands in the ``trial`` column for each: their labels where these differ, else their places."""
    labels = [trial.label for trial in trials]
    if not all(labels) or len(set(labels)) < len(labels):
        return list(range(1, len(trials) + 1))
    return [int(label) for label in labels] if all(map(str.isdecimal, labels)) else labels


def read_motions(
    path: Path,
    n_joint: int,
    mapping: ColumnMap,
    rate_hz: float | None,
    required: Collection[str],
    vectors: Mapping[str, Sequence[str]] = TIP,
) -> list[Measured]:
    """Read every motion of a file of columns, see `protocol.tables.files.TABLES`.

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
    vectors : mapping of str to sequence of str
        Roles with one column an axis, and how those are called.

    Raises
    ------
    DataError
        If a column is missing or does not fit, or time does not rise within a motion.
    """
    whole = read_file(path, n_joint, mapping, rate_hz, required, vectors)
    motions = [trial for motion in whole for trial in _by_label(motion)]
    for motion in motions:
        require_rising(motion)
    return motions


def read_file(
    path: Path,
    n_joint: int,
    mapping: ColumnMap,
    rate_hz: float | None,
    required: Collection[str],
    vectors: Mapping[str, Sequence[str]],
    joint_roles: Sequence[str] = JOINT_ROLES,
) -> list[Measured]:
    """Read a file without parting it by trials: one motion, or one a cell of a ``.mat``.

    Parameters are those of `read_motions`, and ``vectors`` and ``joint_roles`` as in
    `protocol.tables.reader.read_tables`.
    """
    tables = read_tables(
        path, n_joint, mapping, required, vectors=vectors, joint_roles=joint_roles, rate_hz=rate_hz
    )
    several = len(tables) > 1
    return [
        from_table(table, path, f"{path.stem}({cell + 1})" if several else path.stem)
        for cell, table in enumerate(tables)
    ]


def from_table(table: Table, path: Path, name: str) -> Measured:
    """Return rows of a table as a motion."""
    columns = {role: values for role, values in table.groups.items() if role != "t"}
    return Measured(
        name,
        str(path),
        table.first_row,
        table.groups["t"][:, 0],
        columns,
        notes=table.notes,
        labels=table.labels,
        stated=table.stated,
    )


def require_rising(motion: Measured) -> None:
    """Raise a DataError where time stands still or runs backwards."""
    stamps.require_rising(motion.t, motion.where, motion.first_row)


def _by_label(whole: Measured) -> list[Measured]:
    """Part a file by its ``trial`` column; each trial must stand in one piece."""
    if whole.labels is None:
        return [whole]
    trials = stamps.trial_rows(whole.labels, len(whole.t), whole.where, whole.first_row)
    parts = [whole.rows(begin, end, f"{whole.name}/{label}") for label, begin, end in trials]
    return [part if k == 0 else replace(part, notes=()) for k, part in enumerate(parts)]  # of the file, said once
