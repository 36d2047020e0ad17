"""A Parquet file of columns."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.csv_file import numbers_of
from protocol.tables.expansion import require_modest
from protocol.tables.header import HeadedFile, Header
from protocol.tables.source import Groups, Rows, to_si, uses, wanted
from protocol.tables.table import Labels

#: Of a number, whatever it is packed as.
_CELL_BYTES = 8


class ParquetFile(HeadedFile):
    """A Parquet file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    DataError
        If the file is missing or unreadable.
    """

    notes: tuple[Note, ...] = ()

    def __init__(self, path: Path) -> None:
        self.path = path
        with _readable(path):
            self._schema = pyarrow.parquet.read_schema(path)
        self._header = Header(path, self._schema.names)

    def is_blank(self, address: str) -> bool:
        """Say whether no row has a value in a column."""
        if pa.types.is_null(self._schema.field(address).type):
            return True
        with _readable(self.path):
            file = pyarrow.parquet.ParquetFile(self.path)
            if not file.metadata.num_rows or not file.metadata.num_row_groups:
                return False
            for column in (file.metadata.row_group(0).column(k) for k in range(file.metadata.num_columns)):
                statistics = column.statistics
                if column.path_in_schema == address and statistics is not None and statistics.has_null_count:
                    if statistics.null_count < column.num_values:
                        return False
            require_modest(self.path, file.metadata.num_rows * _CELL_BYTES, f"column {address!r}")
            column = file.read(columns=[address]).column(0)
            return bool(column.null_count == len(column))

    def read(self, groups: Groups, label: str | None) -> list[Rows]:
        """Return groups of columns side by side, as one motion.

        Raises
        ------
        DataError
            If a column holds text or a value that is not finite, naming column and row (from 1).
        """
        names = wanted(groups, label)
        with _readable(self.path):
            rows = pyarrow.parquet.read_metadata(self.path).num_rows
            require_modest(self.path, rows * len(names) * _CELL_BYTES, "what is asked for")
            table = pyarrow.parquet.read_table(self.path, columns=names)
        return [self._rows(table, groups, label, 0)]

    def streams(self, groups: Groups, label: str | None) -> bool:
        """Say that a Parquet file can be read block by block."""
        return True

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Rows]:
        """Return the same, at most some number of rows at a time and in bounded memory."""
        first = 0
        with _readable(self.path), pyarrow.parquet.ParquetFile(self.path, pre_buffer=False) as file:
            for batch in file.iter_batches(rows, columns=wanted(groups, label), use_threads=False):
                yield self._rows(pa.Table.from_batches([batch]), groups, label, first)
                first += batch.num_rows

    def _rows(self, table: pa.Table, groups: Groups, label: str | None, first_row: int) -> Rows:
        labels = None if label is None else _texts(table.column(label))
        left = uses(groups)
        matrices: dict[str, NDArray[np.float64]] = {}
        for key, group in groups.items():
            matrix = np.empty((table.num_rows, len(group)))
            for place, column in enumerate(group):
                found = table.column(column.address)
                where = f"{self.path}: column {column.address!r}"
                if not _is_number(found.type):
                    raise DataError(f"{where} holds {found.type}, expected numbers")
                matrix[:, place] = to_si(numbers_of(found), column, where, first_row)
                left[column.address] -= 1
                if not left[column.address]:
                    table = table.drop_columns([column.address])
            matrices[key] = matrix
        return Rows(matrices, labels)


def _is_number(kind: pa.DataType) -> bool:
    is_a = pa.types
    numbers = (is_a.is_integer, is_a.is_floating, is_a.is_boolean, is_a.is_decimal, is_a.is_null)
    return any(is_kind(kind) for is_kind in (*numbers, is_a.is_timestamp, is_a.is_duration))


def _texts(column: pa.ChunkedArray) -> Labels:
    return np.array(["" if cell is None else str(cell) for cell in column.to_pylist()], dtype=np.str_)


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
