"""An NPZ file: read some rows at a time where it holds a row a name, and never more than what is wanted."""

import re
import struct
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack
from io import BytesIO
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.expansion import require_modest
from protocol.tables.header import Header
from protocol.tables.nested import NestedFile
from protocol.tables.source import Groups, Rows, to_si, wanted
from protocol.tables.trees import Array, Node
from protocol.tables.units import Unit

_MEMBER = ".npy"
_NPY = b"\x93NUMPY"
#: How long the header of an array is, in files of version 1, and later.
_SHORT, _LONG = struct.Struct("<H"), struct.Struct("<I")
#: Bytes of a header that numpy reads.
_HEADER_BYTES = 10_000
#: The name that an address begins with; what may follow leads inside an array, see `protocol.tables.address`.
_HEAD = re.compile(r"[^.\[\](){}]+")
#: What the reader of a damaged file is seen to raise.
_DAMAGE = (
    OSError,
    ValueError,
    LookupError,
    EOFError,
    RuntimeError,
    MemoryError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)

#: How long an array is, and of what; None where it is no row of numbers, words or stamps.
Shape = tuple[int, np.dtype[np.generic]] | None


class NpzFile:
    """An opened NPZ file of columns: 1-D arrays of equal length, each under a name of its own, or tables.

    Parameters
    ----------
    path : Path

    Raises
    ------
    DataError
        If the file is missing or cannot be read as NPZ.
    """

    notes: tuple[Note, ...] = ()

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.exists():
            raise DataError(f"{path}: there is no such file")
        try:
            with path.open("rb") as file:
                if file.read(len(_NPY)) == _NPY:
                    raise ValueError("it holds one bare array, expected one a name")
            with zipfile.ZipFile(path) as archive:
                members = [member for member in archive.namelist() if member.endswith(_MEMBER)]
        except _DAMAGE as error:
            raise _damaged(path, error) from error
        self._names = tuple(member.removesuffix(_MEMBER) for member in members)
        self._tree = NestedFile(path, _Members(path, self._names))
        self._header = Header(path, self._names)
        self._shapes: dict[str, Shape] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the arrays."""
        return self._names

    def match(self, wanted: str, dimensions: Collection[str]) -> str | None:
        """Return an address with the full name of the array that it begins with, if that is there."""
        return self._tree.match(wanted, dimensions)

    def unit(self, address: str, dimensions: Collection[str]) -> Unit | None:
        """Return the unit that a name states."""
        return self._tree.unit(address, dimensions)

    def nearest(self, wanted: str) -> str | None:
        """Return the name that is most like one that is not there."""
        return self._header.nearest(wanted)

    def is_blank(self, address: str) -> bool:
        """Say that an array that is there holds values."""
        return False

    def read(self, groups: Groups, label: str | None) -> list[Rows]:
        """Return groups of columns side by side, see `NestedFile.read`; other arrays are not looked at."""
        return self._tree.read(groups, label)

    def streams(self, groups: Groups, label: str | None) -> bool:
        """Say whether these columns can be read side by side; others have to be read whole."""
        shapes = [self._shape(name) for name in wanted(groups, label)]
        return all(shapes) and len({shape[0] for shape in shapes if shape is not None}) == 1

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Rows]:
        """Return groups of columns that stream, at most `rows` rows at a time.

        Raises
        ------
        DataError
            If the file is damaged, or a value is not finite, naming column and row (from 1).
        """
        names = wanted(groups, label)
        n = max(shape[0] for shape in map(self._shape, names) if shape is not None)
        try:
            with ExitStack() as stack:
                archive = stack.enter_context(zipfile.ZipFile(self.path))
                columns = {name: stack.enter_context(archive.open(name + _MEMBER)) for name in names}
                for stream in columns.values():
                    _read_header(stream)
                for first in range(0, n, rows):
                    count = min(rows, n - first)
                    part = {name: self._take(stream, name, count) for name, stream in columns.items()}
                    yield self._rows(part, groups, label, first)
        except _DAMAGE as error:
            raise _damaged(self.path, error) from error

    def _shape(self, name: str) -> Shape:
        if name not in self._shapes:
            self._shapes[name] = self._shape_of(name) if name in self._names else None
        return self._shapes[name]

    def _shape_of(self, name: str) -> Shape:
        try:
            with zipfile.ZipFile(self.path) as archive, archive.open(name + _MEMBER) as stream:
                shape, kind = _read_header(stream)
        except _DAMAGE as error:
            raise _damaged(self.path, error) from error
        return (shape[0], kind) if len(shape) == 1 and kind.kind in "biufUSmM" else None

    def _take(self, stream: IO[bytes], name: str, rows: int) -> NDArray[np.generic]:
        shape = self._shapes[name]
        assert shape is not None
        values = np.frombuffer(stream.read(rows * shape[1].itemsize), dtype=shape[1])
        if len(values) != rows:
            raise EOFError(f"array {name!r} ends early")
        return values

    def _rows(self, part: dict[str, NDArray[np.generic]], groups: Groups, label: str | None, first: int) -> Rows:
        matrices = {
            key: np.column_stack(
                [to_si(part[column.address], column, f"{self.path}: {column.address}", first) for column in group]
            )
            for key, group in groups.items()
        }
        labels = None if label is None else np.array([str(value) for value in part[label].tolist()], dtype=np.str_)
        return Rows(matrices, labels)


class _Members(Mapping[str, Node]):
    """The arrays of an NPZ file by name, each read when it is asked for; nothing is unpickled."""

    def __init__(self, path: Path, names: Collection[str]) -> None:
        self._path, self._names = path, names
        self._last: tuple[str, Array] | None = None  # joints are columns of one table
        self._asked: dict[str, int] = {}  # bytes of each array that was read so far

    def __getitem__(self, name: str) -> Node:
        if self._last is not None and self._last[0] == name:
            return self._last[1]
        if name not in self._names:
            raise KeyError(name)
        try:
            with zipfile.ZipFile(self._path) as archive:
                self._asked[name] = archive.getinfo(name + _MEMBER).file_size
                require_modest(self._path, sum(self._asked.values()), "what is asked for")
            with self._path.open("rb") as file:
                found: Array = np.load(file, allow_pickle=False)[name]
        except _DAMAGE as error:
            if "allow_pickle" in str(error):
                raise DataError(f"{self._path}: {name!r} holds pickled objects, expected numbers") from error
            raise _damaged(self._path, error) from error
        self._last = name, found
        return found

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _damaged(path: Path, error: BaseException) -> DataError:
    return DataError(f"{path}: cannot be read as NPZ ({' '.join(str(error).split())})")


def _read_header(stream: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[np.generic]]:
    version = npy.read_magic(stream)
    layout, read = (_SHORT, npy.read_array_header_1_0) if version == (1, 0) else (_LONG, npy.read_array_header_2_0)
    size = stream.read(layout.size)
    (length,) = layout.unpack(size)
    if length > _HEADER_BYTES:  # numpy would read it all before it refuses it
        raise ValueError(f"an array's header has {length} bytes, expected at most {_HEADER_BYTES}")
    shape, _, kind = read(BytesIO(size + stream.read(length)))
    return shape, kind
