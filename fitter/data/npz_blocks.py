"""An NPZ file read some rows at a time, so that a file larger than memory can be read as well."""

import re
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from fitter.data.tables import Groups, Table, require_finite, wanted
from limbcal.errors import DataError

_MEMBER = ".npy"
#: The name that an address begins with; what may follow leads inside an array, see `fitter.data.nested`.
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

#: How long an array is, and of what; None where it is no row of numbers or words.
Header = tuple[int, np.dtype[np.generic]] | None


class NpzFile:
    """An opened NPZ file of columns: 1-D arrays of equal length, each under a name of its own.

    Parameters
    ----------
    path : Path

    Raises
    ------
    DataError
        If the file is missing or cannot be read as NPZ.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.exists():
            raise DataError(f"{path}: there is no such file")
        try:
            with zipfile.ZipFile(path) as archive:
                self._headers = {
                    member.removesuffix(_MEMBER): _header(archive, member) for member in archive.namelist()
                }
        except _DAMAGE as error:
            raise DataError(f"{path}: cannot be read as NPZ ({error})") from error

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the arrays."""
        return tuple(self._headers)

    def has(self, address: str) -> bool:
        """Say whether the name that an address begins with is there."""
        head = _HEAD.match(address)
        return head is not None and head[0] in self._headers

    def streams(self, groups: Groups, label: str | None) -> bool:
        """Say whether these columns can be read side by side; others have to be read whole."""
        headers = [self._headers.get(name) for name in wanted(groups, label)]
        return all(headers) and len({header[0] for header in headers if header is not None}) == 1

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Table]:
        """Return groups of columns that stream, at most so many rows at a time.

        Raises
        ------
        DataError
            If the file is damaged, or a value is not finite, naming column and row (from 1).
        """
        names = wanted(groups, label)
        n = max(header[0] for header in map(self._headers.get, names) if header is not None)
        try:
            with ExitStack() as stack:
                archive = stack.enter_context(zipfile.ZipFile(self.path))
                columns = {name: stack.enter_context(archive.open(name + _MEMBER)) for name in names}
                for stream in columns.values():
                    _read_header(stream)
                for first in range(0, n, rows):
                    count = min(rows, n - first)
                    part = {name: self._take(stream, name, count) for name, stream in columns.items()}
                    yield self._table(part, groups, label, first)
        except _DAMAGE as error:
            raise DataError(f"{self.path}: cannot be read as NPZ ({error})") from error

    def _take(self, stream: IO[bytes], name: str, rows: int) -> NDArray[np.generic]:
        header = self._headers[name]
        assert header is not None
        values = np.frombuffer(stream.read(rows * header[1].itemsize), dtype=header[1])
        if len(values) != rows:
            raise EOFError(f"array {name!r} ends early")
        return values

    def _table(self, part: dict[str, NDArray[np.generic]], groups: Groups, label: str | None, first: int) -> Table:
        numbers = {key: np.column_stack([part[name] for name in group]) for key, group in groups.items()}
        matrices = {key: values.astype(np.float64) for key, values in numbers.items()}
        for key, group in groups.items():
            for place, name in enumerate(group):
                require_finite(matrices[key][:, place], f"{self.path}: {name}", first)
        labels = None if label is None else np.array([str(value) for value in part[label].tolist()], dtype=np.str_)
        return Table(matrices, labels)


def _header(archive: zipfile.ZipFile, member: str) -> Header:
    with archive.open(member) as stream:
        shape, kind = _read_header(stream)
    return (shape[0], kind) if len(shape) == 1 and kind.kind in "biufUS" else None


def _read_header(stream: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[np.generic]]:
    version = npy.read_magic(stream)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, kind = read(stream)
    return shape, kind
