"""What is read of a file of columns, in one form whatever the file's own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limbcal.note import Note

Floats = NDArray[np.float64]
Labels = NDArray[np.str_]


@dataclass(frozen=True)
class Table:
    """Columns of one motion, or a block of its rows.

    Attributes
    ----------
    groups : mapping of str to ndarray of shape (n, columns of the group)
        By role (``t``, ``q``, ``dq``, ``ddq``, ``tau``, ``ref``, ``on``, ``kp``, ``kv``, ``tip``, ``a``): finite
        numbers in SI units.
    names : mapping of str to sequence of str
        By role, what the file calls each of the columns: for notes and errors.
    labels : ndarray of str, shape (n,), or None
        The ``trial`` column.
    stated : frozenset of str
        Canonical names (``t``, ``q1``, ``tau2``, ``tipx`` …) of the columns whose unit the file or the mapping
        states: a magnitude that surprises is no question of units there.
    first_row : int
        How many data rows of the file come before.
    notes : tuple of Note
        What was found while reading: units that were heeded, rows that were left out.
    origin_s : float
        What was taken off stamps that float64 could not hold [s]: dates, and nanoseconds since 1970.
    """

    groups: Mapping[str, Floats]
    names: Mapping[str, Sequence[str]]
    labels: Labels | None = None
    stated: frozenset[str] = frozenset()
    first_row: int = 0
    notes: tuple[Note, ...] = ()
    origin_s: float = 0.0
