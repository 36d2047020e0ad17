"""What every format gives: names, units that it states, and columns that are read when they are wanted."""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.clock import Clock, Floats
from protocol.tables.table import Labels
from protocol.tables.units import Unit


@dataclass(frozen=True)
class Column:
    """A column that is to be read.

    Attributes
    ----------
    address : str
        What the file calls it, or the way to it within an array or a struct.
    factor : float
        What its numbers are multiplied by for SI.
    clock : Clock, optional
        Given for time stamps, which it turns into seconds; `factor` is its own then.
    per_file : bool
        It may be one number of the file, or one a cell, that stands for every row.
    """

    address: str
    factor: float = 1.0
    clock: Clock | None = field(default=None, compare=False)
    per_file: bool = False


Groups = Mapping[str, Sequence[Column]]


@dataclass(frozen=True)
class Rows:
    """Some rows of some columns.

    Attributes
    ----------
    groups : mapping of str to ndarray of shape (n, columns of the group)
        Finite numbers in SI.
    labels : ndarray of str, shape (n,), or None
    """

    groups: Mapping[str, Floats]
    labels: Labels | None


class Source(Protocol):
    """An opened file of columns."""

    path: Path

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, for an error to list."""

    @property
    def notes(self) -> tuple[Note, ...]:
        """What was found while opening it."""

    def match(self, wanted: str, dimensions: Collection[str]) -> str | None:
        """Return the address of a column that is wanted by its name, with or without its unit; None if none is."""

    def unit(self, address: str, dimensions: Collection[str]) -> Unit | None:
        """Return the unit that the file states for a column."""

    def nearest(self, wanted: str) -> str | None:
        """Return the name that is most like one that is not there."""

    def is_blank(self, address: str) -> bool:
        """Say whether a column has a name and not one value."""

    def read(self, groups: Groups, label: str | None) -> list[Rows]:
        """Return groups of columns of equal length, one for every motion that the file itself keeps apart."""

    def streams(self, groups: Groups, label: str | None) -> bool:
        """Say whether `blocks` can give these columns."""

    def blocks(self, groups: Groups, label: str | None, rows: int) -> Iterator[Rows]:
        """Return the same, about `rows` rows at a time and in bounded memory."""


def wanted(groups: Groups, label: str | None) -> list[str]:
    """Return the addresses of all columns of some groups, each once, and of the one of text."""
    names = [column.address for group in groups.values() for column in group]
    return list(dict.fromkeys(names if label is None else [*names, label]))


def uses(groups: Groups) -> Counter[str]:
    """Return how often each address is wanted."""
    return Counter(column.address for group in groups.values() for column in group)


def to_si(values: NDArray[np.generic], column: Column, where: str, first_row: int = 0) -> Floats:
    """Return a column's numbers in SI.

    Parameters
    ----------
    values : ndarray of shape (n,)
        Numbers, or stamps of NumPy's ``datetime64`` or ``timedelta64``.
    column : Column
    where : str
        File and column, for an error.
    first_row : int
        How many rows of the file come before.

    Raises
    ------
    DataError
        If these are no numbers, or one is not finite, naming its row (from 1).
    """
    clock = column.clock
    if values.dtype.kind in "mM":
        if clock is None:
            raise DataError(f"{where} holds time stamps, expected numbers")
        missing = np.isnat(values)
        if missing.any():
            row = first_row + int(missing.argmax()) + 1
            raise DataError(f"{where}, row {row}: found no time, expected a stamp")
        clock.factor = 1e-9
        values = values.astype(f"{values.dtype.kind}8[ns]").astype(np.int64)
    if values.dtype.kind not in "biuf":
        found = f" such as {values[0]!r}" if len(values) else ""
        raise DataError(f"{where} holds {_kind(values)}{found}, expected numbers")
    if clock is not None and values.dtype.kind != "b":
        require_finite(values, where, first_row)
        return clock.seconds(values)
    floats = values.astype(np.float64, copy=False)
    require_finite(floats, where, first_row)
    return floats if column.factor == 1.0 else floats * column.factor


def require_finite(values: NDArray[np.generic], where: str, first_row: int = 0) -> None:
    """Raise a DataError that names the row (from 1) of the first value that is not finite."""
    finite = np.isfinite(values)
    if not finite.all():
        row = int(np.argmin(finite))
        found = "nothing or NaN" if np.isnan(values[row]) else str(values[row])
        raise DataError(f"{where}, row {first_row + row + 1}: found {found}, expected a finite number")


def _kind(values: NDArray[np.generic]) -> str:
    return {"U": "text", "S": "text", "O": "objects", "c": "complex numbers"}.get(
        values.dtype.kind, values.dtype.name
    )
