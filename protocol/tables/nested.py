"""Columns out of files that hold arrays within names: MATLAB ``.mat``, JSON, and NPZ files of tables.

An address is the way to a column: ``name``, ``name.field`` (of a struct, an object, or of every record in a
list), ``name[k]`` (row or column k of a table, whichever is not time; number k of a row of gains) and ``name(k)``
(cell k of a cell array or element k of a list). Everything is counted from 1, as ``{j}`` is. A list of tables
without ``(k)`` is a set of motions, one a cell, and ``(a:b)`` are some of them; ``(join)`` and ``(join a:b)`` put
cells end to end to the one motion that they are.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.header import Header
from protocol.tables.source import Column, Groups, Rows, to_si
from protocol.tables.table import Floats, Labels
from protocol.tables.trees import Array, Node, fields_of, fields_within, load_tree
from protocol.tables.units import Unit

Kind = TypeVar("Kind", bound=np.generic)

_STEP = re.compile(r"\.(?P<field>[^.\[\](){}]+)|\[(?P<row>[^\]]*)\]|\((?P<cell>[^)]*)\)")
_HEAD = re.compile(r"[^.\[\](){}]+")
#: Some cells, or all of them, kept apart or joined.
_CELLS = re.compile(r"(?P<join>join)?\s*(?:(?P<first>\d*)\s*:\s*(?P<last>\d*))?")


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
        head = _HEAD.match(wanted)
        if whole is not None or head is None:
            return whole
        first = self._header.match(head[0], dimensions)
        return None if first is None else first + wanted[head.end() :]

    def unit(self, address: str, dimensions: Collection[str]) -> Unit | None:
        """Return the unit that the last name in an address states."""
        if address in self._header.names:
            return self._header.unit(address, dimensions)
        names = [step["field"] for step in _STEP.finditer(address) if step["field"]]
        head = _HEAD.match(address)
        last = names[-1] if names else head[0] if head else address
        return self._header.unit(last, dimensions)

    def nearest(self, wanted: str) -> str | None:
        """Return the name that is most like one that is not there."""
        return self._header.nearest(wanted)

    def is_blank(self, address: str) -> bool:
        """Say whether a column holds nothing but nulls."""
        try:
            row = _row_of(self._walk(address, ""), "")
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
        motions = max((len(cells) for cells in found.values()), default=1)
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
        node = self._walk(address, where, is_row)
        if isinstance(node, list):
            return [take(_row_of(cell, f"{where}, cell {k + 1}", is_row), where) for k, cell in enumerate(node)]
        return [take(_row_of(node, where, is_row), where)]

    def _walk(self, address: str, where: str, is_row: bool = False) -> Node:
        if address in fields_of(self._root):  # a name may have brackets in it
            return _field(self._root, address, where)
        head = _HEAD.match(address)
        if head is None:
            raise DataError(f"{where}: expected the name of an array first")
        return _walked(_field(self._root, head[0], where), address[head.end() :], where, is_row)


def _walked(node: Node, steps: str, where: str, is_row: bool) -> Node:
    """Return what the rest of an address leads to."""
    place = 0
    while place < len(steps):
        step = _STEP.match(steps, place)
        if step is None:
            raise DataError(f"{where}: cannot read {steps[place:]!r}, expected .field, [k], (k), (a:b) or (join)")
        place = step.end()
        if step["field"] is not None:
            node = _field(node, step["field"], where)
        elif step["row"] is not None:
            node = _row(node, _index(step["row"], where), where, is_row)
        elif (several := _CELLS.fullmatch(step["cell"].strip())) is not None and step["cell"].strip():
            some = _some(node, several, where)
            inner = [_walked(cell, steps[place:], f"{where}, cell {k}", is_row) for k, cell in some]
            if several["join"] is None:
                return inner
            return np.concatenate([_row_of(one, where) for one in inner])
        else:
            node = _cell(node, _index(step["cell"], where), where)
    return node


def _some(node: Node, wanted: re.Match[str], where: str) -> list[tuple[int, Node]]:
    """Return the cells that are wanted, with their numbers."""
    if not isinstance(node, list):
        raise DataError(f"{where}: ({wanted[0]}) of something with no cells")
    first, last = int(wanted["first"] or 1), int(wanted["last"] or len(node))
    if not 1 <= first <= last <= len(node):
        raise DataError(f"{where}: ({wanted[0]}) of something with {len(node)} cells, expected some of them")
    return [(k, node[k - 1]) for k in range(first, last + 1)]


def _by_motion(column: Column, cells: list[Floats], motions: int) -> list[Floats]:
    """Part one number a motion, as a list of records gives them, into one cell a motion."""
    if column.per_file and len(cells) == 1 and motions > 1 and len(cells[0]) == motions:
        return [cells[0][k : k + 1] for k in range(motions)]
    return cells


def _spread(columns: Mapping[Column, Floats]) -> dict[Column, Floats]:
    """Let one number stand for every row, where it may."""
    rows = max((len(values) for values in columns.values()), default=0)
    return {
        column: np.repeat(values, rows) if column.per_file and len(values) == 1 else values
        for column, values in columns.items()
    }


def _field(node: Node, name: str, where: str) -> Node:
    fields = fields_of(node)
    if name not in fields:
        there = f"one of {', '.join(fields)}" if fields else "an array, for it has no fields"
        raise DataError(f"{where}: there is no {name!r}, expected {there}")
    if isinstance(node, Mapping):
        return fields[name]
    column: list[Node] = []
    for row, record in enumerate(node):
        if not isinstance(record, Mapping) or name not in record:
            raise DataError(f"{where}: record {row + 1} has no {name!r}, expected it in every record")
        column.append(record[name])
    return _gather(column)


def _gather(nodes: list[Node]) -> Node:
    """Make one column of a list of single values; leave a list of anything else a list."""
    if nodes and all(isinstance(node, np.ndarray) and node.ndim == 0 for node in nodes):
        return np.array([node.item() for node in nodes if isinstance(node, np.ndarray)])
    return nodes


def _row(node: Node, k: int, where: str, is_row: bool) -> Node:
    if isinstance(node, list):
        return [_row(cell, k, where, is_row) for cell in node]
    if is_row and isinstance(node, np.ndarray) and (node.ndim == 1 or (node.ndim == 2 and 1 in node.shape)):
        numbers: Array = node.ravel()
        if not 1 <= k <= len(numbers):
            raise DataError(f"{where}: [{k}] of a row of {len(numbers)} numbers, expected 1 to {len(numbers)}")
        return numbers[k - 1 : k].reshape(())
    if not isinstance(node, np.ndarray) or node.ndim != 2:
        found = f"shape {node.shape}" if isinstance(node, np.ndarray) else "fields"
        raise DataError(f"{where}: [{k}] of something with {found}, expected a table of two dimensions")
    table = node if node.shape[0] < node.shape[1] else node.T  # the longer side is time
    if not 1 <= k <= len(table):
        raise DataError(f"{where}: [{k}] of a table with {len(table)} rows, expected 1 to {len(table)}")
    row: Array = table[k - 1]
    return row


def _cell(node: Node, k: int, where: str) -> Node:
    if not isinstance(node, list) or not 1 <= k <= len(node):
        held = f"{len(node)} cells, expected 1 to {len(node)}" if isinstance(node, list) else "no cells"
        raise DataError(f"{where}: ({k}) of something with {held}")
    return node[k - 1]


def _index(text: str, where: str) -> int:
    if not text.strip().isdigit():
        raise DataError(f"{where}: {text!r} is no index, expected a whole number from 1")
    return int(text)


def _row_of(node: Node, where: str, may_be_one: bool = False) -> Array:
    """Return a node as one row of values."""
    if not isinstance(node, np.ndarray):
        raise DataError(f"{where}: holds fields or cells, expected an array; name a field or a cell of it")
    if (node.ndim == 0 and not may_be_one) or max(node.shape, default=1) != node.size:
        raise DataError(f"{where}: has shape {node.shape}, expected a row of numbers; name one with [k]")
    return node.ravel()


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
    return np.array([str(value) for value in row.tolist()], dtype=np.str_)
