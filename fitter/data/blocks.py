"""Measurements of any length, read some rows at a time."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fitter.data.columns import ColumnMap
from fitter.data.motions import Measured, read_file
from fitter.data.npz_blocks import NpzFile
from fitter.data.roles import find_roles, listed
from fitter.data.tables import TableFile
from limbcal.errors import DataError

#: Formats that can be read some rows at a time.
STREAMED = (".csv", ".parquet", ".npz")


def read_blocks(
    path: Path, n_joint: int, mapping: ColumnMap, rate_hz: float | None, rows: int
) -> Iterator[Measured]:
    """Read the joint motion in a file, about so many rows at a time and in the order of the file.

    Parameters
    ----------
    path : Path
        CSV, Parquet or NPZ. ``.mat``, ``.json`` and NPZ files of tables are no streams and come whole, one block
        a cell.
    n_joint : int
        Number of joints of the arm.
    mapping : ColumnMap
        Which column plays which role.
    rate_hz : float or None
        Rate of the samples where the file has no time.
    rows : int

    Yields
    ------
    Measured
        Consecutive rows, not yet parted by trials; `labels` says which trial each is of.

    Raises
    ------
    DataError
        If a column is missing or does not fit.
    """
    source = _open(path)
    if source is None:
        yield from read_file(path, n_joint, mapping, rate_hz, ("q",), {})
        return
    roles = find_roles(source, n_joint, mapping, ("q",), {})
    if "t" not in roles and rate_hz is None:
        raise DataError(
            f"{path}: no column 't' among {listed(source)}, expected time stamps, or else the rate of the samples"
        )
    label = roles.pop("trial", [None])[0]
    if isinstance(source, NpzFile) and not source.streams(roles, label):
        yield from read_file(path, n_joint, mapping, rate_hz, ("q",), {})
        return
    first = 0
    for table in source.blocks(roles, label, rows):
        columns = dict(table.groups)
        n = len(columns["q"])
        stamps = columns.pop("t")[:, 0] if "t" in columns else np.arange(first, first + n) / (rate_hz or 1.0)
        if n:
            yield Measured(path.stem, str(path), first, stamps, columns, labels=table.labels)
        first += n
    if not first:
        raise DataError(f"{path}: there is a header but no row, expected samples")


def _open(path: Path) -> TableFile | NpzFile | None:
    suffix = path.suffix.lower()
    if suffix not in STREAMED:
        return None
    return NpzFile(path) if suffix == ".npz" else TableFile(path)
