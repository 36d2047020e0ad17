"""Columns out of CSV and Parquet files: only those that are wanted, as finite float64."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from limbcal.errors import DataError

Floats = NDArray[np.float64]
Labels = NDArray[np.str_]
Groups = Mapping[str, Sequence[str]]

COMMENTS = ("//", "#", "%")
_ARROW_ROW = re.compile(r"Row #(\d+)")


@dataclass(frozen=True)
class Table:
    """What was read of a file.

    Attributes
    ----------
    groups : mapping of str to ndarray of shape (n, columns of the group)
        Finite numbers.
    labels : ndarray of str, shape (n,), or None
        One column of text.
    """

    groups: Mapping[str, Floats]
    labels: Labels | None


class Columns(Protocol):
    """What has columns in it, opened far enough to know their names."""

    path: Path

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, for an error to list."""

    def has(self, address: str) -> bool:
        """Say whether there is such a column."""


class Source(Columns, Protocol):
    """A file that is read whole."""

    def read(self, groups: Groups, label: str | None) -> list[Table]:
        """Return groups of columns of equal length, a table for every motion that the file itself keeps apart."""


class TableFile:
    """A CSV or Parquet file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    DataError
        If the file is missing, unreadable or has no header.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._read: Callable[[Sequence[str], str | None], pa.Table]
        if path.suffix.lower() == ".csv":
            self._skip, self._delimiter, header = _csv_header(path)
            self._read = self._read_csv
        else:
            with _readable(path):
                header = pyarrow.parquet.read_schema(path).names
            self._read = self._read_parquet
        twice = sorted({name for name in header if header.count(name) > 1})
        if twice:
            raise DataError(f"{path}: column {twice[0]!r} is there {header.count(twice[0])} times, expected once")
        self._names = tuple(header)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns in the file's order."""
        return self._names

    def has(self, address: str) -> bool:
        """Say whether there is a column of this name."""
        return address in self._names

    def read(self, groups: Groups, label: str | None) -> list[Table]:
        """Return groups of columns side by side, in one table.

        The file is read once, and what was taken over is given back, so that hardly more than twice the numbers
        asked for are ever in memory.

        Raises
        ------
        DataError
            If a column holds text or a value that is not finite, naming column and row (data rows, from 1).
        """
        table = self._read(wanted(groups, label), label)
        return [self._table(table, groups, label, 0)]

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Table]:
        """Return the same, about so many rows at a time, in the order of the file and in bounded memory.

        Raises
        ------
        DataError
            As `read` does, once the row is reached.
        """
        names, first = wanted(groups, label), 0
        for batch in self._batches(names, label, rows):
            yield self._table(pa.Table.from_batches([batch]), groups, label, first)
            first += batch.num_rows

    def _table(self, table: pa.Table, groups: Groups, label: str | None, first_row: int) -> Table:
        labels = None if label is None else _texts(table.column(label))
        left = Counter(name for group in groups.values() for name in group)
        matrices: dict[str, Floats] = {}
        for key, group in groups.items():
            matrix = np.empty((table.num_rows, len(group)))
            for place, name in enumerate(group):
                matrix[:, place] = self._floats(table.column(name), name, first_row)
                left[name] -= 1
                if not left[name]:
                    table = table.drop_columns([name])
            matrices[key] = matrix
        return Table(matrices, labels)

    def _floats(self, column: pa.ChunkedArray, name: str, first_row: int) -> Floats:
        kind = column.type
        if not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind)):
            raise DataError(f"{self.path}: column {name!r} holds {kind}, expected numbers")
        values = np.asarray(column.cast(pa.float64()).to_numpy(), dtype=np.float64)
        require_finite(values, f"{self.path}: column {name!r}", first_row)
        return values

    def _read_parquet(self, names: Sequence[str], label: str | None) -> pa.Table:
        with _readable(self.path):
            return pyarrow.parquet.read_table(self.path, columns=list(names))

    def _read_csv(self, names: Sequence[str], label: str | None, threads: bool = True) -> pa.Table:
        try:
            return pyarrow.csv.read_csv(self.path, **self._csv_options(names, label, threads))
        except pa.ArrowInvalid as error:
            if threads:  # row numbers are only known to a single thread
                return self._read_csv(names, label, threads=False)
            raise DataError(f"{self.path}: {self._explain(str(error))}") from error

    def _csv_options(self, names: Sequence[str], label: str | None, threads: bool) -> dict[str, object]:
        types = {name: pa.string() if name == label else pa.float64() for name in names}
        return {
            "read_options": pyarrow.csv.ReadOptions(
                column_names=list(self._names), skip_rows=self._skip + 1, use_threads=threads
            ),
            "parse_options": pyarrow.csv.ParseOptions(delimiter=self._delimiter),
            "convert_options": pyarrow.csv.ConvertOptions(column_types=types, include_columns=list(names)),
        }

    def _batches(self, names: Sequence[str], label: str | None, rows: int) -> Iterator[pa.RecordBatch]:
        if self.path.suffix.lower() != ".csv":
            with _readable(self.path), pyarrow.parquet.ParquetFile(self.path, pre_buffer=False) as file:
                yield from file.iter_batches(rows, columns=list(names), use_threads=False)
            return
        try:  # row numbers are only known to a single thread
            with pyarrow.csv.open_csv(self.path, **self._csv_options(names, label, threads=False)) as reader:
                yield from reader
        except pa.ArrowInvalid as error:
            raise DataError(f"{self.path}: {self._explain(str(error))}") from error

    def _explain(self, reason: str) -> str:
        """Turn pyarrow's account of a bad cell into ours."""
        found = _ARROW_ROW.search(reason)
        row = f"row {int(found[1]) - self._skip - 1}: " if found else ""
        column = re.search(r"column #(\d+)", reason)
        cell = re.search(r"invalid value '(.*)'", reason, re.DOTALL)
        if column and cell:
            return f"{row}column {self._names[int(column[1])]!r} holds {cell[1]!r}, expected a number"
        cells = re.search(r"Expected (\d+) columns, got (\d+)", reason)
        if cells:
            return f"{row}{cells[2]} cells, expected {cells[1]} as in the header"
        return f"{row}cannot be read as CSV ({' '.join(reason.split())})"


def wanted(groups: Groups, label: str | None) -> list[str]:
    """Return the addresses of all columns of some groups, each once, and of the one of text."""
    names = [name for group in groups.values() for name in group]
    return list(dict.fromkeys(names if label is None else [*names, label]))


def require_finite(values: Floats, where: str, first_row: int = 0) -> None:
    """Raise a DataError that names the row (from 1) of the first value that is not finite."""
    finite = np.isfinite(values)
    if not finite.all():
        row = int(np.argmin(finite))
        found = "nothing or NaN" if np.isnan(values[row]) else str(values[row])
        raise DataError(f"{where}, row {first_row + row + 1}: found {found}, expected a finite number")


def _texts(column: pa.ChunkedArray) -> Labels:
    return np.array(["" if cell is None else str(cell) for cell in column.to_pylist()], dtype=np.str_)


def _csv_header(path: Path) -> tuple[int, str, list[str]]:
    """Return how many lines stand before the header, what parts its cells, and the cells."""
    try:
        with path.open(encoding="utf-8-sig") as lines:
            for number, line in enumerate(lines):
                if line.strip() and not line.startswith(COMMENTS):
                    delimiter = max(",;\t", key=line.count)
                    header = [cell.strip().strip('"') for cell in line.split(delimiter)]
                    if all(_is_number(cell) for cell in header):
                        raise DataError(f"{path}: the first row is {line.strip()!r}, expected names of columns")
                    return number, delimiter, header
    except FileNotFoundError as error:
        raise DataError(f"{path}: there is no such file") from error
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: cannot be read ({error})") from error
    raise DataError(f"{path}: the file is empty, expected a header row and numbers")


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Turn what goes wrong while a Parquet file is read into one sentence."""
    if not path.exists():
        raise DataError(f"{path}: there is no such file")
    if path.stat().st_size == 0:
        raise DataError(f"{path}: the file is empty")
    try:
        yield
    except (OSError, pa.ArrowException) as error:
        raise DataError(f"{path}: cannot be read as Parquet ({' '.join(str(error).split())})") from error
