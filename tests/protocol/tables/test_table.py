"""A table says what it was not told: no labels, no notes, from the first row on, on its own clock."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from protocol.tables.table import Table


def test_a_table_of_columns_alone_begins_at_the_first_row() -> None:
    table = Table({"t": np.zeros((3, 1))}, {"t": ("time",)})
    assert table.labels is None and table.stated == frozenset() and table.notes == ()
    assert (table.first_row, table.origin_s) == (0, 0.0)


def test_a_table_does_not_change() -> None:
    with pytest.raises(FrozenInstanceError):
        Table({}, {}).first_row = 7  # type: ignore[misc]
