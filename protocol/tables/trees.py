"""MATLAB ``.mat``, JSON and JSON lines as trees: mappings, lists and arrays, whatever the format calls them."""

import json
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.expansion import require_modest

#: What the readers of damaged files are seen to raise.
_DAMAGE = (
    OSError,
    ValueError,
    TypeError,
    LookupError,
    EOFError,
    ArithmeticError,
    MemoryError,
    RecursionError,
    zipfile.BadZipFile,
    zlib.error,
)
_MAT = (".mat",)
_HDF5 = b"\x89HDF\r\n\x1a\n"
#: Size of the header before the HDF5 of a MATLAB 7.3 file [bytes].
_MAT_HEADER = 512
#: … of one of version 5 to 7, the place of its order of bytes there, and the type of an element that is packed.
_MAT5_HEADER, _MAT5_ENDIAN, _MAT5_PACKED = 128, slice(126, 128), 15
#: How pandas writes a table as one object: names, and rows of cells.
_SPLIT = ("columns", "data")

Array = NDArray[np.generic]
#: A struct or object is a mapping, a cell array or list of anything but numbers a list.
Node = Mapping[str, "Node"] | list["Node"] | Array


def load_tree(path: Path) -> tuple[Node, tuple[Note, ...]]:
    """Read a whole file.

    Parameters
    ----------
    path : Path
        ``.mat`` (up to version 7), ``.json``, or ``.jsonl`` and ``.ndjson`` with an object a line.

    Returns
    -------
    tree : mapping or list
        Single values are arrays without dimensions.
    notes : tuple of Note
        A last line that is cut off and was left out.

    Raises
    ------
    DataError
        If the file is missing or cannot be read as what its suffix says.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such file")
    kind = path.suffix.lower()
    try:
        return (_load_mat(path), ()) if kind in _MAT else _load_json(path)
    except NotImplementedError as error:
        raise _newer(path) from error
    except _DAMAGE as error:
        raise DataError(f"{path}: cannot be read as {kind} ({' '.join(str(error).split())})") from error


def _load_mat(path: Path) -> Node:
    with path.open("rb") as file:
        head = file.read(_MAT_HEADER + len(_HDF5))
    if head.startswith(_HDF5) or head[_MAT_HEADER:] == _HDF5:
        raise _newer(path)
    return _Variables(path, {name: kind for name, _, kind in _by_scipy("whosmat", path)})


def _by_scipy(reader: str, path: Path, **options: object) -> Any:
    """Call a reader of ``.mat`` of scipy's, which takes half a second to load: no other file need wait for it."""
    scipy_io = import_module("scipy.io")
    try:
        return getattr(scipy_io, reader)(str(path), **options)
    except scipy_io.matlab.MatReadError as error:
        raise ValueError(str(error)) from error


class _Variables(Mapping[str, "Node"]):
    """The variables of a ``.mat`` file, each read when it is asked for."""

    def __init__(self, path: Path, kinds: Mapping[str, str]) -> None:
        self._path, self._kinds = path, kinds
        self._read: dict[str, Node] = {}

    def __getitem__(self, name: str) -> "Node":
        if name not in self._kinds:
            raise KeyError(name)
        if name not in self._read:
            require_modest(self._path, _unpacked_bytes(self._path), "what is in it")
            try:
                content = _by_scipy("loadmat", self._path, variable_names=[name])
                self._read[name] = _from_mat(content[name])
            except (*_DAMAGE, NotImplementedError) as error:
                reason = " ".join(str(error).split())
                raise DataError(f"{self._path}: {name!r} cannot be read ({reason})") from error
        return self._read[name]

    def __contains__(self, name: object) -> bool:
        return name in self._kinds

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(self._kinds)

    def has_fields(self, name: str) -> bool:
        """Say whether a variable is a struct."""
        return self._kinds[name] == "struct"


def _unpacked_bytes(path: Path) -> int:
    """Return how long the variables of a ``.mat`` file say that they are, unpacked.

    Each is an element: its type and length, and where it is packed, its own type and length first in it.
    """
    total = 0
    with path.open("rb") as file:
        head = file.read(_MAT5_HEADER)
        if head[_MAT5_ENDIAN] not in (b"IM", b"MI"):
            return path.stat().st_size  # version 4 packs nothing
        layout = struct.Struct("<II" if head[_MAT5_ENDIAN] == b"IM" else ">II")
        while len(tag := file.read(layout.size)) == layout.size:
            kind, length = layout.unpack(tag)
            after = file.tell() + length
            if kind == _MAT5_PACKED:
                inner = zlib.decompressobj().decompress(file.read(min(length, _MAT5_HEADER)), layout.size)
                length = layout.unpack(inner)[1] if len(inner) == layout.size else 0
            total += length
            file.seek(after)
    return total


def fields_within(root: Node, name: str) -> Mapping[str, Node]:
    """Return the fields of what a tree has under a name, without reading what has none."""
    if isinstance(root, _Variables) and not root.has_fields(name):
        return {}
    return fields_of(fields_of(root)[name])


def fields_of(node: Node) -> Mapping[str, Node]:
    """Return the fields of a node: its own, or those of the first of its records."""
    if isinstance(node, Mapping):
        return node
    if isinstance(node, list) and node and isinstance(node[0], Mapping):
        return node[0]
    return {}


def _newer(path: Path) -> DataError:
    return DataError(f"{path}: a MATLAB 7.3 file, expected one saved in MATLAB with save(…, '-v7')")


def _from_mat(value: NDArray[Any]) -> Node:
    """Turn cells into lists and structs into mappings, whatever the shape they are stored in."""
    if value.dtype.names:
        fields = {name: value[name].ravel(order="F") for name in value.dtype.names}
        records: list[Node] = [
            {name: _from_mat(np.asarray(cells[k])) for name, cells in fields.items()} for k in range(value.size)
        ]
        return records[0] if len(records) == 1 else records
    if value.dtype == object:
        return [_from_mat(np.asarray(cell)) for cell in value.ravel(order="F")]
    return value.reshape(()) if value.size == 1 else value


def _load_json(path: Path) -> tuple[Node, tuple[Note, ...]]:
    text = path.read_text(encoding="utf-8-sig")
    lines = path.suffix.lower() != ".json"
    notes: tuple[Note, ...] = ()
    if not lines:
        try:
            content = json.loads(text)
        except json.JSONDecodeError as error:
            lines = error.msg == "Extra data"  # an object a line, whatever the suffix says
            if not lines:
                raise
    if lines:
        content, notes = _json_lines(text, path)
    root = _from_json(_table(content))
    if isinstance(root, np.ndarray):
        raise ValueError("it holds a bare list, expected names")
    return root, notes


def _json_lines(text: str, path: Path) -> tuple[list[object], tuple[Note, ...]]:
    """Return the object of every line; a last line that is cut off is left out."""
    found: list[object] = []
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    for number, line in lines:
        try:
            record = json.loads(line)
        except json.JSONDecodeError as error:
            if number == lines[-1][0] and found and not text.endswith("\n"):
                said = f"line {number}, the last one, is cut off; it was left out, the rest was used"
                return found, (Note("cut", said, source=str(path), row=number),)
            raise ValueError(f"line {number}: {error.msg}, expected an object a line") from error
        if not isinstance(record, dict):
            raise ValueError(f"line {number} holds {line[:20]!r}, expected an object with names")
        found.append(record)
    return found, ()


def _table(content: object) -> object:
    """Return a table that pandas wrote as one object as columns by name; anything else as it is."""
    if not isinstance(content, dict):
        return content
    names, rows = (content.get(name) for name in _SPLIT)
    if isinstance(names, list) and isinstance(rows, list) and all(isinstance(row, list) for row in rows):
        return dict(zip(map(str, names), map(list, zip(*rows, strict=True)), strict=True))
    if content and all(isinstance(value, dict) and "0" in value for value in content.values()):
        return {name: list(value.values()) for name, value in content.items()}
    return content


def _from_json(value: object) -> Node:
    if isinstance(value, dict):
        return {str(name): _from_json(inner) for name, inner in value.items()}
    if isinstance(value, list):
        if not any(isinstance(inner, (dict, list)) for inner in value):
            return _row(value)
        nodes = [_from_json(inner) for inner in value]
        rows = [node for node in nodes if isinstance(node, np.ndarray)]
        if len(rows) == len(nodes) and len({row.shape for row in rows}) == 1:
            return np.array(value)
        return nodes
    return np.array(value)


def _row(value: list[object]) -> Array:
    """Return a row of single values; what is no number stays what it is."""
    if all(isinstance(cell, (int, float)) for cell in value):
        return np.array(value)
    if all(isinstance(cell, str) for cell in value):
        return np.array(value, dtype=np.str_)
    return np.array(value, dtype=object)
