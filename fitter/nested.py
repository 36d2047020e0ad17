"""Columns out of files that hold arrays within names: NPZ, MATLAB ``.mat`` and JSON.

An address is the way to a column: ``name``, ``name.field`` (of a struct, an object, or of every record in a
list), ``name[k]`` (row or column k of a table, whichever is not time) and ``name(k)`` (cell k of a cell array or
element k of a list). Everything is counted from 1, as ``{j}`` is. A list of tables without ``(k)`` is a set of
motions, one a cell.
"""

import json
import re
import zipfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np
import scipy.io
from numpy.typing import NDArray

from fitter.tables import Columns, Floats, Texts, require_finite
from limbcal.errors import DataError

Array = NDArray[np.generic]
Node = Mapping[str, "Node"] | list["Node"] | Array

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
        if not path.exists():
            raise DataError(f"{path}: there is no such file")
        kind = path.suffix.lower()
        load = {".npz": _load_npz, ".mat": _load_mat, ".json": _load_json}[kind]
        try:
            self._root: Node = load(path)
        except NotImplementedError as error:
            raise DataError(f"{path}: a MATLAB 7.3 file, expected one saved with '-v7' or older") from error
        except (OSError, ValueError, TypeError, KeyError, zipfile.BadZipFile) as error:
            raise DataError(f"{path}: cannot be read as {kind} ({' '.join(str(error).split())})") from error

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

    def read(self, addresses: Sequence[str], texts: Collection[str] = ()) -> list[Columns]:
        """Return the columns at some addresses, one dictionary a motion.

        Raises
        ------
        DataError
            If an address leads nowhere, a column is no 1-D row of finite numbers, columns of one motion differ
            in length, or addresses lead to different numbers of cells.
        """
        found = {address: self._column(address, address in texts) for address in addresses}
        cells = {address: len(column) for address, column in found.items() if isinstance(column, list)}
        counts = set(cells.values())
        if len(counts) > 1:
            said = ", ".join(f"{address} {count}" for address, count in cells.items())
            raise DataError(f"{self.path}: the cell arrays hold {said} cells, expected the same number")
        motions = [
            {address: column[k] if isinstance(column, list) else column for address, column in found.items()}
            for k in range(counts.pop() if counts else 1)
        ]
        for motion in motions:
            lengths = {address: len(column) for address, column in motion.items()}
            if len(set(lengths.values())) > 1:
                said = ", ".join(f"{address} {length}" for address, length in lengths.items())
                raise DataError(f"{self.path}: the columns have lengths {said}, expected one length")
        return motions

    def _column(self, address: str, text: bool) -> Floats | Texts | list[Floats | Texts]:
        where = f"{self.path}: {address}"
        node = self._walk(address, where)
        if isinstance(node, list):
            return [_flat(cell, f"{where}, cell {k + 1}", text) for k, cell in enumerate(node)]
        return _flat(node, where, text)

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
        raise DataError(f"{where}: there is no {name!r}, expected one of {', '.join(fields) or 'no fields at all'}")
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
        held = f"{len(node)} cells" if isinstance(node, list) else "no cells"
        raise DataError(f"{where}: ({k}) of something with {held}")
    return node[k - 1]


def _index(text: str, where: str) -> int:
    if not text.strip().isdigit():
        raise DataError(f"{where}: {text!r} is no index, expected a whole number from 1")
    return int(text)


def _flat(node: Node, where: str, text: bool) -> Floats | Texts:
    """Return a node as a column."""
    if not isinstance(node, np.ndarray):
        raise DataError(f"{where}: holds fields or cells, expected an array; name a field or a cell of it")
    if max(node.shape, default=1) != node.size or node.ndim == 0:
        raise DataError(f"{where}: has shape {node.shape}, expected a row of numbers; name one with [k]")
    column = node.ravel()
    if text:
        return np.array([str(value) for value in column.tolist()], dtype=np.str_)
    if column.dtype == object:
        column = np.array([np.nan if value is None else value for value in column.tolist()])
    if column.dtype.kind not in "biuf":
        raise DataError(f"{where}: holds {column.dtype.name} such as {column[0]!r}, expected numbers")
    values = column.astype(np.float64)
    require_finite(values, where)
    return values


def _load_npz(path: Path) -> Node:
    with path.open("rb") as file:
        archive = np.load(file, allow_pickle=False)
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise ValueError("it holds one bare array, expected one a name")
        return {name: archive[name] for name in archive.files}


def _load_mat(path: Path) -> Node:
    with path.open("rb") as file:
        content = scipy.io.loadmat(file)
    return {name: _from_mat(value) for name, value in content.items() if not name.startswith("__")}


def _from_mat(value: Array) -> Node:
    """Turn cells into lists and structs into mappings, whatever the shape they are stored in."""
    if value.dtype.names:
        records: list[Node] = [
            {name: _from_mat(np.asarray(record[name])) for name in value.dtype.names}
            for record in value.ravel(order="F")
        ]
        return records[0] if len(records) == 1 else records
    if value.dtype == object:
        return [_from_mat(np.asarray(cell)) for cell in value.ravel(order="F")]
    return value.reshape(()) if value.size == 1 else value


def _load_json(path: Path) -> Node:
    root = _from_json(json.loads(path.read_text(encoding="utf-8")))
    if isinstance(root, np.ndarray):
        raise ValueError("it holds a bare list, expected names")
    return root


def _from_json(value: object) -> Node:
    if isinstance(value, dict):
        return {str(name): _from_json(inner) for name, inner in value.items()}
    if isinstance(value, list):
        nodes = [_from_json(inner) for inner in value]
        rows = [node for node in nodes if isinstance(node, np.ndarray)]
        if len(rows) == len(nodes) and len({row.shape for row in rows}) == 1:
            return np.array(value)
        return nodes
    return np.array(value)
