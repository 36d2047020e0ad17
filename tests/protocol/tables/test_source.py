"""From a file's values to numbers in SI."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.clock import Clock
from protocol.tables.source import Column, to_si, uses, wanted


def test_numbers_of_every_kind_become_si():
    assert to_si(np.array([1, 2], np.int16), Column("x", 1e-3), "x").tolist() == [0.001, 0.002]
    assert to_si(np.array([True, False]), Column("x"), "x").tolist() == [1.0, 0.0]
    stamps = np.array(["2026-03-01T00:00:00", "2026-03-01T00:00:00.5"], "datetime64[ms]")
    assert to_si(stamps, Column("t", clock=Clock()), "t").tolist() == [0.0, 0.5]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.array([1.0, np.nan]), "x, row 12: found nothing or NaN"),
        (np.array([np.inf, 1.0]), "x, row 11: found inf"),
        (np.array(["a", "b"]), "x holds text such as .*'a'.*, expected numbers"),
        (np.array([1j]), "x holds complex numbers"),
        (np.array(["2026-03-01"], "datetime64[s]"), "x holds time stamps, expected numbers"),
    ],
)
def test_what_is_no_number_is_said_with_its_row(values, said):
    with pytest.raises(DataError, match=said):
        to_si(values, Column("x"), "x", first_row=10)
    missing = np.array(["2026-03-01", "NaT"], "datetime64[s]")
    with pytest.raises(DataError, match="t, row 2: found no time"):
        to_si(missing, Column("t", clock=Clock()), "t")


def test_every_column_is_wanted_once():
    groups = {"a": [Column("x"), Column("y")], "b": [Column("x")]}
    assert wanted(groups, "trial") == ["x", "y", "trial"] and uses(groups) == {"x": 2, "y": 1}
