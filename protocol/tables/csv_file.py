"""A text file of columns, in any of the ways in which programs write them."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.csv_end import last_row_end
from protocol.tables.dialect import BLANKS, COMMENTS, HEAD_BYTES, dialect_of, encoding_of, is_stamp
from protocol.tables.header import HeadedFile, Header
from protocol.tables.source import Column, Groups, Rows, to_si, uses, wanted
from protocol.tables.table import Labels

_ARROW_ROW = re.compile(r"Row #(\d+)")
_WHOLE = re.compile(r"[-+]?\d+")
_ZONE = re.compile(r"(?:Z|[-+]\d\d:?\d\d)$")
#: Whole numbers from here on are not all float64.
_EXACT = 2**53


class CsvFile(HeadedFile):
    """A CSV file.

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
        self._content, encoding = _content(path)
        head = self._content[:HEAD_BYTES].to_pybytes()
        self._dialect = dialect_of(head, encoding, path)
        self._header = Header(path, self._dialect.names, self._dialect.units)
        self._stop, notes = last_row_end(self._content, self._dialect, path)
        passed = self._dialect.preamble
        text = f"{passed} line{'' if passed == 1 else 's'} before the header were passed over"
        self.notes = (*((Note("preamble", text, source=str(path)),) if passed else ()), *notes)

    def is_blank(self, address: str) -> bool:
        """Say whether no row has a value in a column."""
        place = self._dialect.names.index(address)
        sample = self._dialect.sample
        if not sample or any(row[place : place + 1] not in ((), ("",)) for row in sample):
            return False
        column = self._table([address], {address: pa.binary()}).column(0)
        return not any(cell.strip() for cell in column.to_pylist() if cell)

    def read(self, groups: Groups, label: str | None) -> list[Rows]:
        """Return groups of columns side by side, as one motion.

        The file is read once, and what was taken over is given back, so that hardly more than twice the numbers
        asked for are ever in memory.

        Raises
        ------
        DataError
            If a column holds text or a value that is not finite, naming column and row (data rows, from 1).
        """
        names = wanted(groups, label)
        return [self._rows(self._table(names, self._types(groups, label)), groups, label, 0)]

    def streams(self, groups: Groups, label: str | None) -> bool:
        """Say that a CSV file can be read block by block."""
        return True

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Rows]:
        """Return the same, a few thousand rows at a time, in the order of the file and in bounded memory.

        Raises
        ------
        DataError
            As `read` does, once the row is reached.
        """
        if self._body.size == 0:
            return
        first = 0
        try:  # row numbers are only known to a single thread
            options = self._options(wanted(groups, label), self._types(groups, label), threads=False)
            with pyarrow.csv.open_csv(pa.BufferReader(self._body), **options) as reader:
                for batch in reader:
                    yield self._rows(pa.Table.from_batches([batch]), groups, label, first)
                    first += batch.num_rows
        except pa.ArrowInvalid as error:
            raise DataError(f"{self.path}: {self._explain(str(error))}") from error

    @property
    def _body(self) -> pa.Buffer:
        body = self._content.slice(self._dialect.start, max(0, self._stop - self._dialect.start))
        if self._dialect.delimiter != BLANKS:
            return body
        lines = (b"\t".join(line.split()) for line in body.to_pybytes().splitlines())
        return pa.py_buffer(b"\n".join(lines))

    def _types(self, groups: Groups, label: str | None) -> dict[str, pa.DataType]:
        types = {column.address: self._type(column) for group in groups.values() for column in group}
        return types if label is None else {**types, label: pa.binary()}

    def _type(self, column: Column) -> pa.DataType:
        place = self._dialect.names.index(column.address)
        sample = self._dialect.sample
        first = sample[0][place].strip() if sample and len(sample[0]) > place else ""
        if column.clock is None:
            return pa.float64()
        if is_stamp(first):
            return pa.timestamp("ns", "UTC") if _ZONE.search(first) else pa.timestamp("ns")
        exact = _WHOLE.fullmatch(first) and abs(int(first)) >= _EXACT
        return pa.int64() if exact else pa.float64()

    def _table(self, names: Sequence[str], types: dict[str, pa.DataType], threads: bool = True) -> pa.Table:
        if self._body.size == 0:
            return pa.table({name: pa.array([], types[name]) for name in names})
        try:
            table = pyarrow.csv.read_csv(pa.BufferReader(self._body), **self._options(names, types, threads))
        except pa.ArrowInvalid as error:
            if threads:  # row numbers are only known to a single thread
                return self._table(names, types, threads=False)
            raise DataError(f"{self.path}: {self._explain(str(error))}") from error
        return table.rename_columns(list(names))

    def _options(self, names: Sequence[str], types: dict[str, pa.DataType], threads: bool) -> dict[str, object]:
        places = {name: str(self._dialect.names.index(name)) for name in names}
        delimiter = "\t" if self._dialect.delimiter == BLANKS else self._dialect.delimiter
        return {
            "read_options": pyarrow.csv.ReadOptions(
                column_names=[str(k) for k in range(len(self._dialect.names))], use_threads=threads
            ),
            "parse_options": pyarrow.csv.ParseOptions(delimiter=delimiter, invalid_row_handler=_pass_over_remarks),
            "convert_options": pyarrow.csv.ConvertOptions(
                column_types={places[name]: types[name] for name in names},
                include_columns=[places[name] for name in names],
                decimal_point=self._dialect.decimal,
            ),
        }

    def _rows(self, table: pa.Table, groups: Groups, label: str | None, first_row: int) -> Rows:
        table = table.rename_columns(wanted(groups, label))
        labels = None if label is None else self._texts(table.column(label))
        left = uses(groups)
        matrices: dict[str, NDArray[np.float64]] = {}
        for key, group in groups.items():
            matrix = np.empty((table.num_rows, len(group)))
            for place, column in enumerate(group):
                where = f"{self.path}: column {column.address!r}"
                matrix[:, place] = to_si(numbers_of(table.column(column.address)), column, where, first_row)
                left[column.address] -= 1
                if not left[column.address]:
                    table = table.drop_columns([column.address])
            matrices[key] = matrix
        return Rows(matrices, labels)

    def _texts(self, column: pa.ChunkedArray) -> Labels:
        encoding = self._dialect.encoding
        distinct = column.dictionary_encode().combine_chunks()
        words = [(word or b"").decode(encoding, errors="replace") for word in distinct.dictionary.to_pylist()]
        places = distinct.indices.fill_null(-1).to_numpy(zero_copy_only=False)
        labels: Labels = np.array([*words, ""], dtype=np.str_)[places]
        return labels

    def _explain(self, reason: str) -> str:
        """Turn pyarrow's account of a bad cell into ours."""
        found = _ARROW_ROW.search(reason)
        row = f"row {int(found[1])}: " if found else ""
        column = re.search(r"column #(\d+)", reason)
        cell = re.search(r"invalid value '(.*)'", reason, re.DOTALL)
        if column and cell:
            expected = "seconds, or a time such as 2026-03-01T12:00:00.25" if ":" in cell[1] else "a number"
            return f"{row}column {self._dialect.names[int(column[1])]!r} holds {cell[1]!r}, expected {expected}"
        cells = re.search(r"Expected (\d+) columns, got (\d+)", reason)
        if cells:
            return f"{row}{cells[2]} cells, expected {cells[1]} as in the header"
        return f"{row}cannot be read as CSV ({' '.join(reason.split())})"


def numbers_of(column: pa.ChunkedArray) -> NDArray[np.generic]:
    """Return a column of Arrow as an array; a value that is missing is NaN, or NaT where it is a time."""
    kind = column.type
    if pa.types.is_timestamp(kind):
        column, kind = column.cast(pa.timestamp("ns")), pa.timestamp("ns")
    if pa.types.is_decimal(kind) or pa.types.is_float16(kind) or pa.types.is_null(kind):
        column = column.cast(pa.float64())
    if column.null_count and pa.types.is_integer(kind):
        column = column.cast(pa.float64(), safe=False)
    return np.asarray(column.to_numpy())


def _pass_over_remarks(row: pyarrow.csv.InvalidRow) -> str:
    return "skip" if row.text.lstrip().startswith(COMMENTS) else "error"


def _content(path: Path) -> tuple[pa.Buffer, str]:
    """Return all bytes of a file, without reading them yet where that can be, and their encoding."""
    try:
        with path.open("rb") as file:
            encoding = encoding_of(file.read(HEAD_BYTES))
        if path.stat().st_size == 0:
            return pa.py_buffer(b""), encoding
        if encoding.startswith("utf-16"):
            text = path.read_bytes().decode(encoding, errors="replace").lstrip("\ufeff")
            return pa.py_buffer(text.encode()), "utf-8"
        with pa.memory_map(str(path)) as file:
            return file.read_buffer(), encoding
    except FileNotFoundError as error:
        raise DataError(f"{path}: there is no such file") from error
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror or error})") from error
