"""Columns out of files that hold arrays within names: MATLAB ``.mat``, JSON, and NPZ files of tables.

A column is found by its address, see `protocol.tables.address`.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Set
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.address import head_of, last_name, reached, row_of
from protocol.tables.header import Header
from protocol.tables.source import Column, Groups, Rows, to_si
from protocol.tables.table import Floats, Labels
from protocol.tables.trees import Array, Node, fields_of, fields_within, load_tree
from protocol.tables.units import Unit

Kind = TypeVar("Kind", bound=np.generic)


class NestedFile:
    """An opened ``.mat``, ``.json`` or ``.jsonl`` file, or any other tree.

    Parameters
    ----------
    path : Path
        The file; its suffix says the format.
    root : mapping or list, optional
        What is in it, if that is known already.

    Raises
    ------
    DataError
        If the file is missing or cannot be read as what its suffix says.
    """

    notes: tuple[Note, ...] = ()

    def __init__(self, path: Path, root: Node | None = None) -> None:
        self.path = path
        if root is None:
            root, self.notes = load_tree(path)
        self._root = root
        self._header = Header(path, tuple(fields_of(root)))

    @property
    def names(self) -> tuple[str, ...]:
        """Names at the top, and of the fields one step below."""
        found: list[str] = []
        for name in fields_of(self._root):
            inner = fields_within(self._root, name)
            found += [f"{name}.{field}" for field in inner] if inner else [name]
        return tuple(found)

    def match(self, wanted: str, dimensions: Collection[str]) -> str | None:
        """Return an address with the full name of what it begins with, if that is there."""
        whole = self._header.match(wanted, dimensions)
        head = head_of(wanted)
        if whole is not None or not head:
            return whole
        first = self._header.match(head, dimensions)
        return None if first is None else first + wanted[len(head) :]

    def unit(self, address: str, dimensions: Collection[str]) -> Unit | None:
        """Return the unit that the last name in an address states."""
        if address in self._header.names:
            return self._header.unit(address, dimensions)
        return self._header.unit(last_name(address), dimensions)

    def nearest(self, wanted: str) -> str | None:
        """Return the name that is most like one that is not there."""
        return self._header.nearest(wanted)

    def is_blank(self, address: str) -> bool:
        """Say whether a column holds nothing but nulls."""
        try:
            row = row_of(reached(self._root, address, ""), "")
        except DataError:
            return False
        return row.dtype == object and len(row) > 0 and all(value is None for value in row.tolist())

    def streams(self, groups: Groups, label: str | None) -> bool:
        """Say that such a file comes whole."""
        return False

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Rows]:
        """Return what `read` returns."""
        yield from self.read(groups, label)

    def read(self, groups: Groups, label: str | None) -> list[Rows]:
        """Return groups of columns side by side, one a motion.

        Raises
        ------
        DataError
            If an address leads nowhere, a column is no 1-D row of finite numbers, columns of one motion differ
            in length, or addresses lead to different numbers of cells.
        """
        columns = list(dict.fromkeys(column for group in groups.values() for column in group))
        found = {column: self._cells(column.address, _numbers(column), column.per_file) for column in columns}
        motions = {len(cells) for cells in found.values()}
        found = {column: _by_motion(column, cells, motions) for column, cells in found.items()}
        labels = {} if label is None else {label: self._cells(label, _texts)}
        named = {column.address: cells for column, cells in found.items()}
        counts = {name: len(cells) for name, cells in (named | labels).items() if len(cells) > 1}
        if len(set(counts.values())) > 1:
            said = ", ".join(f"{name} {count}" for name, count in counts.items())
            raise DataError(f"{self.path}: the cell arrays hold {said} cells, expected the same number")
        tables: list[Rows] = []
        for k in range(max(counts.values(), default=1)):
            picked = _spread({column: cells[k % len(cells)] for column, cells in found.items()})
            texts = [cells[k % len(cells)] for cells in labels.values()]
            lengths = {column.address: len(values) for column, values in picked.items()}
            lengths |= {name: len(values) for name, values in zip(labels, texts, strict=True)}
            if len(set(lengths.values())) > 1:
                said = ", ".join(f"{name} {length}" for name, length in lengths.items())
                raise DataError(f"{self.path}: the columns have lengths {said}, expected one length")
            stacked = {key: np.column_stack([picked[column] for column in group]) for key, group in groups.items()}
            tables.append(Rows(stacked, texts[0] if texts else None))
        return tables

    def _cells(
        self, address: str, take: Callable[[Array, str], NDArray[Kind]], is_row: bool = False
    ) -> list[NDArray[Kind]]:
        """Return the column at an address, or one for each of the cells there.

        ``is_row`` says that what has one row and several columns is no table, but numbers for every row of a
        motion: ``[k]`` is one of them.
        """
        where = f"{self.path}: {address}"
        node = reached(self._root, address, where, is_row)
        if isinstance(node, list):
            return [take(row_of(cell, f"{where}, cell {k + 1}", is_row), where) for k, cell in enumerate(node)]
        return [take(row_of(node, where, is_row), where)]


def _by_motion(column: Column, cells: list[Floats], motions: Set[int]) -> list[Floats]:
    """Part one number a motion, as a list of records gives them, into one cell a motion."""
    if column.per_file and len(cells) == 1 and len(cells[0]) in motions:
        return [cells[0][k : k + 1] for k in range(len(cells[0]))]
    return cells


def _spread(columns: Mapping[Column, Floats]) -> dict[Column, Floats]:
    """Let one number stand for every row, where it may."""
    rows = max((len(values) for values in columns.values()), default=0)
    return {
        column: np.repeat(values, rows) if column.per_file and len(values) == 1 else values
        for column, values in columns.items()
    }


def _numbers(column: Column) -> Callable[[Array, str], Floats]:
    """Return what takes a column's values as numbers in SI."""

    def take(row: Array, where: str) -> Floats:
        if row.dtype == object:
            row = np.array([np.nan if value is None else value for value in row.tolist()])
        if row.dtype.kind == "U" and column.clock is not None:
            row = _stamps(row)
        return to_si(row, column, where)

    return take


def _stamps(row: Array) -> Array:
    """Return dates and times in text (ISO 8601) as such, in UTC where they say an offset from it."""
    try:
        return np.array([_stamp(str(text)) for text in row.tolist()], dtype="datetime64[ns]")
    except ValueError:
        return row


def _stamp(text: str) -> np.datetime64:
    found = re.fullmatch(r"(.*?)(?:Z|([-+])(\d\d):?(\d\d))?", text.strip())
    assert found is not None
    sign, hours, minutes = found[2], found[3], found[4]
    stamp: np.datetime64 = np.datetime64(found[1].replace(" ", "T", 1), "ns")
    if sign:
        stamp = stamp - np.timedelta64(int(f"{sign}1") * (60 * int(hours) + int(minutes)), "m")
    return stamp


def _texts(row: Array, where: str) -> Labels:
    return np.array([_text(value) for value in row.tolist()], dtype=np.str_)


def _text(value: object) -> str:
    """Return a label; nothing where there is none, as in other formats."""
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    return "" if value is None else str(value)
