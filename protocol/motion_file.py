"""Joint motion handed on as a file: CSV, Parquet or NPZ, one named column a signal."""

import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from limbcal.errors import DataError

Floats = NDArray[np.float64]
Columns = Mapping[str, Floats]

SUFFIXES = (".csv", ".npz", ".parquet")


def read_columns(path: Path) -> dict[str, Floats]:
    """Read every column of a CSV (with a header row), Parquet or NPZ file.

    Parameters
    ----------
    path : Path
        File whose suffix says its format.

    Returns
    -------
    dict of str to ndarray of shape (n,)
        Columns by name, in the file's order. A cell that is empty or no number is NaN.

    Raises
    ------
    DataError
        If the file cannot be read, is of another format, or its columns differ in length.
    """
    readers = {".csv": _read_csv, ".npz": _read_npz, ".parquet": _read_parquet}
    suffix = path.suffix.lower()
    if suffix not in readers:
        raise DataError(f"{path}: the suffix is {suffix!r}, expected one of {', '.join(SUFFIXES)}")
    try:
        columns = readers[suffix](path)
    except FileNotFoundError as error:
        raise DataError(f"{path}: there is no such file") from error
    except (OSError, ValueError, zipfile.BadZipFile, pa.ArrowException) as error:
        reason = " ".join(str(error).split())
        raise DataError(f"{path}: cannot be read as {suffix[1:].upper()} ({reason})") from error
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        said = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise DataError(f"{path}: the columns differ in length ({said}), expected one length")
    return columns


def joint_columns(columns: Columns, prefix: str) -> Floats | None:
    """Return the columns ``prefix1 … prefixn`` side by side.

    Parameters
    ----------
    columns : mapping of str to ndarray of shape (n,)
        What `read_columns` returned.
    prefix : str
        Name without the joint's number, such as ``q`` or ``ref``.

    Returns
    -------
    ndarray of shape (n, n_joint), or None
        None where there is no ``prefix1``.
    """
    found: list[Floats] = []
    while f"{prefix}{len(found) + 1}" in columns:
        found.append(columns[f"{prefix}{len(found) + 1}"])
    return np.column_stack(found) if found else None


def _read_csv(path: Path) -> dict[str, Floats]:
    return _from_table(pyarrow.csv.read_csv(path))


def _read_parquet(path: Path) -> dict[str, Floats]:
    with path.open("rb") as file:
        return _from_table(pyarrow.parquet.read_table(file))


def _from_table(table: pa.Table) -> dict[str, Floats]:
    names = table.column_names
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"the column {twice[0]!r} appears twice")
    return {name: _numbers(table.column(name)) for name in names}


def _numbers(column: pa.ChunkedArray) -> Floats:
    kind = column.type
    if pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_null(kind):
        return np.asarray(column.cast(pa.float64()).to_numpy(zero_copy_only=False), dtype=np.float64)
    return np.array([_number(cell) for cell in column.to_pylist()], dtype=np.float64)


def _number(cell: object) -> float:
    """Read one cell of a column in which at least one is no number."""
    try:
        return float(cell) if isinstance(cell, str) else np.nan
    except ValueError:
        return np.nan


def _read_npz(path: Path) -> dict[str, Floats]:
    with path.open("rb") as file:
        archive = np.load(file, allow_pickle=False)
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise ValueError("it holds one bare array")
        columns = {name: archive[name] for name in archive.files}
    for name, column in columns.items():
        if column.ndim != 1:
            raise ValueError(f"{name!r} has shape {column.shape}, expected one dimension")
    return {name: _numbers(pa.chunked_array([column])) for name, column in columns.items()}
