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


def test_a_row_is_counted_from_the_beginning_of_the_file():
    missing = np.array(["2026-03-01", "NaT"], "datetime64[s]")
    with pytest.raises(DataError, match="t, row 12: found no time, expected a stamp"):
        to_si(missing, Column("t", clock=Clock()), "t", first_row=10)
    with pytest.raises(DataError, match="t, row 13: found nothing or NaN"):
        to_si(np.array([0.0, 1.0, np.nan]), Column("t", clock=Clock()), "t", first_row=10)


def test_stamps_are_nanoseconds_whatever_they_were():
    clock = Clock()
    durations = np.array([0, 1500], "timedelta64[ms]")
    assert to_si(durations, Column("t", clock=clock), "t").tolist() == [0.0, 1.5]
    assert clock.factor == 1e-9
    assert to_si(np.array([True, False]), Column("t", clock=Clock()), "t").tolist() == [1.0, 0.0]


@pytest.mark.parametrize(("values", "kind"), [(np.array([b"a"]), "text"), (np.array([None]), "objects")])
def test_what_stands_there_instead_is_said(values, kind):
    with pytest.raises(DataError, match=f"x holds {kind} such as"):
        to_si(values, Column("x"), "x")
    with pytest.raises(DataError, match=f"x holds {kind}, expected numbers"):
        to_si(values[:0], Column("x"), "x")
