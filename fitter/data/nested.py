"""Columns out of files that hold arrays within names: NPZ, MATLAB ``.mat`` and JSON.

An address is the way to a column: ``name``, ``name.field`` (of a struct, an object, or of every record in a
list), ``name[k]`` (row or column k of a table, whichever is not time) and ``name(k)`` (cell k of a cell array or
element k of a list). Everything is counted from 1, as ``{j}`` is. A list of tables without ``(k)`` is a set of
motions, one a cell.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fitter.data.tables import Floats, Groups, Labels, Table, require_finite
from fitter.data.trees import Array, Node, load_tree
from limbcal.errors import DataError

Kind = TypeVar("Kind", bound=np.generic)

_STEP = re.compile(r"\.(?P<field>[^.\[\](){}]+)|\[(?P<row>[^\]]*)\]|\((?P<cell>[^)]*)\)")
_HEAD = re.compile(r"[^.\[\](){}]+")


class NestedFile:
    """An opened NPZ, ``.mat`` or ``.json`` file.

    Parameters
    ----------
    path : Path
        The file; its suffix says the format.

    Raises
    ------
    DataError
        If the file is missing or cannot be read as what its suffix says.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._root = load_tree(path)

    @property
    def names(self) -> tuple[str, ...]:
        """Names at the top, and of the fields one step below."""
        found: list[str] = []
        for name, node in _fields(self._root).items():
            inner = _fields(node)
            found += [f"{name}.{field}" for field in inner] if inner else [name]
        return tuple(found)

    def has(self, address: str) -> bool:
        """Say whether the name that an address begins with is there."""
        head = _HEAD.match(address)
        return head is not None and head[0] in _fields(self._root)

    def read(self, groups: Groups, label: str | None) -> list[Table]:
        """Return groups of columns side by side, one table a motion.

        Raises
        ------
        DataError
            If an address leads nowhere, a column is no 1-D row of finite numbers, columns of one motion differ
            in length, or addresses lead to different numbers of cells.
        """
        names = [name for group in groups.values() for name in group]
        found = {name: self._cells(name, _floats) for name in names}
        labels = {} if label is None else {label: self._cells(label, _texts)}
        counts = {name: len(cells) for name, cells in (found | labels).items() if len(cells) > 1}
        if len(set(counts.values())) > 1:
            said = ", ".join(f"{name} {count}" for name, count in counts.items())
            raise DataError(f"{self.path}: the cell arrays hold {said} cells, expected the same number")
        tables: list[Table] = []
        for k in range(max(counts.values(), default=1)):
            columns = {name: cells[k % len(cells)] for name, cells in found.items()}
            texts = [cells[k % len(cells)] for cells in labels.values()]
            lengths = {name: len(column) for name, column in columns.items()}
            lengths |= {name: len(column) for name, column in zip(labels, texts, strict=True)}
            if len(set(lengths.values())) > 1:
                said = ", ".join(f"{name} {length}" for name, length in lengths.items())
                raise DataError(f"{self.path}: the columns have lengths {said}, expected one length")
            stacked = {key: np.column_stack([columns[name] for name in group]) for key, group in groups.items()}
            tables.append(Table(stacked, texts[0] if texts else None))
        return tables

    def _cells(self, address: str, take: Callable[[Array, str], NDArray[Kind]]) -> list[NDArray[Kind]]:
        """Return the column at an address, or one for each of the cells there."""
        where = f"{self.path}: {address}"
        node = self._walk(address, where)
        if isinstance(node, list):
            return [take(_row_of(cell, f"{where}, cell {k + 1}"), where) for k, cell in enumerate(node)]
        return [take(_row_of(node, where), where)]

    def _walk(self, address: str, where: str) -> Node:
        head = _HEAD.match(address)
        if head is None:
            raise DataError(f"{where}: expected the name of an array first")
        node = _field(self._root, head[0], where)
        place = head.end()
        while place < len(address):
            step = _STEP.match(address, place)
            if step is None:
                raise DataError(f"{where}: cannot read {address[place:]!r}, expected .field, [k] or (k)")
            place = step.end()
            if step["field"] is not None:
                node = _field(node, step["field"], where)
            elif step["row"] is not None:
                node = _row(node, _index(step["row"], where), where)
            else:
                node = _cell(node, _index(step["cell"], where), where)
        return node


def _fields(node: Node) -> Mapping[str, Node]:
    """Return the fields of a node: its own, or those of the first of its records."""
    if isinstance(node, Mapping):
        return node
    if isinstance(node, list) and node and isinstance(node[0], Mapping):
        return node[0]
    return {}


def _field(node: Node, name: str, where: str) -> Node:
    fields = _fields(node)
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


def _row(node: Node, k: int, where: str) -> Node:
    if isinstance(node, list):
        return [_row(cell, k, where) for cell in node]
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


def _row_of(node: Node, where: str) -> Array:
    """Return a node as one row of values."""
    if not isinstance(node, np.ndarray):
        raise DataError(f"{where}: holds fields or cells, expected an array; name a field or a cell of it")
    if node.ndim == 0 or max(node.shape) != node.size:
        raise DataError(f"{where}: has shape {node.shape}, expected a row of numbers; name one with [k]")
    return node.ravel()


def _floats(row: Array, where: str) -> Floats:
    if row.dtype == object:
        row = np.array([np.nan if value is None else value for value in row.tolist()])
    if row.dtype.kind not in "biuf":
        raise DataError(f"{where}: holds {row.dtype.name} such as {row[0]!r}, expected numbers")
    values = row.astype(np.float64)
    require_finite(values, where)
    return values


def _texts(row: Array, where: str) -> Labels:
    return np.array([str(value) for value in row.tolist()], dtype=np.str_)
