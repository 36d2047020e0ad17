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
    """Read every numeric column of a CSV (with a header row), Parquet or NPZ file.

    Parameters
    ----------
    path : Path
        File whose suffix says its format.

    Returns
    -------
    dict of str to ndarray of shape (n,)
        Columns by name, in the file's order. A column of words is left out, an empty cell is NaN.

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
    return {
        name: table.column(name).cast(pa.float64()).to_numpy(zero_copy_only=False)
        for name in names
        if _is_number(table.schema.field(name).type)
    }


def _is_number(kind: pa.DataType) -> bool:
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_null(kind))


def _read_npz(path: Path) -> dict[str, Floats]:
    with np.load(path, allow_pickle=False) as archive:
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise ValueError("it holds one bare array")
        columns = {name: archive[name] for name in archive.files}
    for name, column in columns.items():
        if column.ndim != 1:
            raise ValueError(f"{name!r} has shape {column.shape}, expected one dimension")
    return {name: column.astype(np.float64) for name, column in columns.items() if column.dtype.kind in "fiu"}
