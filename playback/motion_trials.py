"""The trials of a motion file, each on a clock of its own, with the joints' columns side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np

from arm.effects.trials import TrialId, trial_id
from arm.model import Arm
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.columns import parse_mapping
from protocol.tables.reader import read_tables
from protocol.tables.stamps import holes, leaps, require_rising, require_seconds, trial_rows
from protocol.tables.table import Floats, Table
from protocol.tables.turning import look_like_degrees, top_speeds

Signals = dict[str, Floats]


@dataclass(frozen=True)
class Trials:
    """What is in a file.

    Attributes
    ----------
    signals : dict of int to dict of str to ndarray
        By trial: ``t`` of shape (n,) starting at 0, and the signals found, of shape (n, n_joint).
    begins_s : dict of int to float
        When each began, on the file's own clock; dates are counted from the file's first.
    origins_s : dict of int to float
        What that first was, in seconds since 1970; 0 of stamps that are no dates.
    identities : dict of int to TrialId
        What effects call them.
    names : dict of str to int
        Which number a trial got, by its name; empty where trials have numbers of their own.
    notes : tuple of Note
        What was found while reading, which unit may be meant, where rows are missing or time leaps, and which
        trial got which number.
    """

    signals: dict[int, Signals]
    begins_s: dict[int, float]
    origins_s: dict[int, float]
    identities: dict[int, TrialId]
    names: dict[str, int]
    notes: tuple[Note, ...] = ()

    @property
    def stamps_s(self) -> dict[int, float]:
        """When each trial began by what stands in the file: dates in seconds since 1970."""
        return {number: begin_s + self.origins_s[number] for number, begin_s in self.begins_s.items()}


@dataclass(frozen=True)
class _Piece:
    """Rows of one trial without a leap in them."""

    label: str
    name: str  # the file's stem, and the trial or cell where there are several in it
    own_label: str  # what stands in the column `trial`; nothing without one
    row: int  # the first one's, from 1
    begin_s: float
    origin_s: float
    signals: Signals


def read_trials(
    path: Path,
    arm: Arm,
    needed: Sequence[str],
    optional: Sequence[str] = (),
    columns: str | None = None,
    vectors: Mapping[str, Sequence[str]] | None = None,
    names: Mapping[str, int] | None = None,
) -> Trials:
    """Read the signals of every trial in a joint-motion file.

    Parameters
    ----------
    path : Path
        Any file of columns, see `protocol.tables.files.TABLES`, with ``t`` [s], the numbered columns of every
        needed signal, such as ``q1 … qn``, and where there are several trials a column ``trial``.
    arm : Arm
        Whose joints these are.
    needed, optional : sequence of str
        Names of signals without the joint's number. Further columns are not looked at.
    columns : str, optional
        Mapping of foreign columns, see `protocol.tables.columns.parse_mapping`.
    vectors : mapping of str to sequence of str, optional
        Signals of several plain columns, taken where all of them are there.
    names : mapping of str to int, optional
        Numbers that named trials have in another file, so that they have the same in both.

    Returns
    -------
    Trials
        By the file's own numbers; where trials have names, or time leaps within one, they are counted. A file
        without ``trial`` holds trial 1.

    Raises
    ------
    DataError
        If a needed column is missing, a value is not a number, time does not rise within a trial or is not in
        seconds, or a trial has fewer than two samples.
    """
    mapping = parse_mapping(columns, arm.n_joint)
    joints = (*needed, *optional)
    tables = read_tables(path, arm.n_joint, mapping, needed, vectors=vectors, joint_roles=joints)
    pieces: list[_Piece] = []
    notes: list[Note] = [note for table in tables for note in table.notes]
    unstated = _unstated(tables[0], arm)
    for cell, table in enumerate(tables):
        label = str(cell + 1) if len(tables) > 1 else "1"
        stem = f"{path.stem}({cell + 1})" if len(tables) > 1 else path.stem
        pieces += _pieces(table, label, stem, path, notes)
    notes += _degrees(pieces, unstated, path)
    numbered, named = _numbered(pieces, path, notes, names or {})
    return Trials(
        {number: piece.signals for number, piece in numbered.items()},
        {number: piece.begin_s for number, piece in numbered.items()},
        {number: piece.origin_s for number, piece in numbered.items()},
        {
            number: trial_id(place, piece.own_label, piece.name)
            for place, (number, piece) in enumerate(numbered.items(), 1)
        },
        named,
        tuple(notes),
    )


def _pieces(table: Table, label: str, stem: str, path: Path, notes: list[Note]) -> list[_Piece]:
    """Part a table by trials, and trials where time leaps; note the leaps."""
    found: list[_Piece] = []
    t = table.groups["t"][:, 0]
    for name, begin, end in trial_rows(table.labels, len(t), str(path), table.first_row):
        where = f"{path}: trial {name or label}"
        require_rising(t[begin:end], str(path), table.first_row + begin)
        require_seconds(t[begin:end], where)
        rows = [begin + row for row in leaps(t[begin:end]).tolist()]
        for row in rows:
            text = (
                f"in row {row + 1} t leaps from {t[row - 1]:.9g} to {t[row]:.9g} s: "
                "what follows is played as a trial of its own"
            )
            before, after = float(t[row - 1]), float(t[row])
            notes.append(Note("gap", text, str(path), ("t",), row + 1, before, after))
        for first, last in zip([begin, *rows], [*rows, end], strict=True):
            if last - first < 2:
                if not rows:
                    raise DataError(f"{where} has {last - first} sample, expected at least 2")
                continue
            signals = {role: values[first:last] for role, values in table.groups.items() if role != "t"}
            own = {"t": t[first:last] - t[first], **signals}
            called = f"{stem}/{name}" if name else stem
            notes += _holes(t[first:last], first, str(path))
            found.append(_Piece(name or label, called, name, first + 1, float(t[first]), table.origin_s, own))
    return found


def _unstated(table: Table, arm: Arm) -> dict[str, list[int]]:
    """Return the turning joints, from 0, whose angles and targets are in a unit that nobody states."""
    turning = [j for j, joint in enumerate(arm.joints) if joint.type == "revolute"]
    by_role = {role: [j for j in turning if f"{role}{j + 1}" not in table.stated] for role in ("q", "ref")}
    return {role: joints for role, joints in by_role.items() if joints and role in table.groups}


def _degrees(pieces: Sequence[_Piece], unstated: Mapping[str, Sequence[int]], path: Path) -> list[Note]:
    """Return what there is to say of angles that can hardly be radians: the first trial of each kind of column."""
    notes = []
    for role, joints in unstated.items():
        for piece in pieces:
            t, q = piece.signals["t"], piece.signals[role][:, joints]
            if look_like_degrees(t, q):
                far = int(np.argmax(np.ptp(q, axis=0)))
                text = (
                    f"{role}{joints[far] + 1} goes {np.ptp(q[:, far]):.3g} rad to and fro at up to "
                    f'{top_speeds(t, q)[far]:.3g} rad/s: degrees? Then --columns "{role}={role}{{j}}:deg" '
                    f"({role}={role}{{j}}:rad if it is radians)"
                )
                notes.append(Note("unit", text, str(path), tuple(f"{role}{j + 1}" for j in joints), piece.row))
                break
    return notes


def _holes(t: Floats, first_row: int, path: str) -> list[Note]:
    """Return what there is to say of rows that are missing in a piece."""
    rows = holes(t)
    if not rows.size:
        return []
    row, before, after = first_row + int(rows[0]) + 1, float(t[rows[0] - 1]), float(t[rows[0]])
    more = f", and so {rows.size - 1} more time(s)" if rows.size > 1 else ""
    text = (
        f"in row {row} t goes from {before:.9g} to {after:.9g} s{more}: rows are missing, and what is played "
        "between was not measured"
    )
    return [Note("gap", text, path, ("t",), row, before, after)]


def _numbered(
    pieces: Sequence[_Piece], path: Path, notes: list[Note], names: Mapping[str, int]
) -> tuple[dict[int, _Piece], dict[str, int]]:
    """Return pieces by number, and the numbers of those that have names.

    Numbers are the labels' own, if each is a whole number, else those that names have elsewhere, else places.
    """
    labels = [piece.label for piece in pieces]
    numbers = [_whole(label) for label in labels]
    if len(set(labels)) < len(labels):  # pieces of one trial
        named, counted = {}, dict(enumerate(pieces, 1))
    elif None in numbers or len(set(numbers)) < len(numbers):
        further = count(max(names.values(), default=0) + 1)
        named = {label: names[label] if label in names else next(further) for label in labels}
        counted = {named[piece.label]: piece for piece in pieces}
    else:
        return {number: piece for number, piece in zip(numbers, pieces, strict=True) if number is not None}, {}
    if len(set(labels)) > 1 or min(counted) > 1:
        said = ", ".join(f"{k} is {piece.label!r} from row {piece.row}" for k, piece in counted.items())
        notes.append(Note("trials", f"trials are counted: {said}", str(path), ("trial",)))
    return counted, named


def _whole(label: str) -> int | None:
    """Return the whole number that a label is."""
    try:
        value = float(label)
    except ValueError:
        return None
    return int(value) if value.is_integer() else None
