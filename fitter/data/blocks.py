"""Measurements of any length, read some rows at a time."""

from collections.abc import Iterator
from pathlib import Path

from fitter.data.motions import Measured, from_table
from protocol.tables.columns import ColumnMap
from protocol.tables.reader import read_table_blocks


def read_blocks(
    path: Path, n_joint: int, mapping: ColumnMap, rate_hz: float | None, rows: int
) -> Iterator[Measured]:
    """Read the joint motion in a file, a block of rows at a time and in the order of the file.

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
    for table in read_table_blocks(path, n_joint, mapping, ("q",), rate_hz, rows):
        yield from_table(table, path, path.stem)
