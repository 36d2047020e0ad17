"""Names of columns, with the units in them."""

from pathlib import Path

import pytest

from limbcal.errors import DataError
from protocol.tables.header import Header

ANGLE = ("angle", "length")
FILE = Path("run.csv")


def test_a_column_is_found_with_or_without_its_unit():
    header = Header(FILE, ["t", "q1 [deg]", "q2_mm", "", "x"])
    assert header.names == ("t", "q1 [deg]", "q2_mm", "x")
    assert header.match("q1", ANGLE) == header.match("q1 [deg]", ANGLE) == "q1 [deg]"
    assert header.match("q2", ANGLE) == "q2_mm" and header.match("q3", ANGLE) is None
    assert header.unit("q1 [deg]", ANGLE).name == "deg" and header.unit("x", ANGLE) is None


def test_the_name_itself_wins_and_two_units_are_a_question():
    assert Header(FILE, ["q1", "q1_deg"]).match("q1", ANGLE) == "q1"
    with pytest.raises(DataError, match=r"run.csv: 'q1' may be any of the columns q1_deg, q1 \[rad\]"):
        Header(FILE, ["q1_deg", "q1 [rad]"]).match("q1", ANGLE)


def test_one_letter_at_the_end_is_a_unit_only_where_it_fits():
    header = Header(FILE, ["q1_s", "tau1_m"])
    assert header.match("q1", ANGLE) is None and header.unit("q1_s", ANGLE) is None
    with pytest.raises(DataError, match="measures a time; expected one of rad"):
        Header(FILE, ["q1_ms"]).unit("q1_ms", ANGLE)


def test_a_row_of_units_overrules_the_name_and_must_be_known():
    header = Header(FILE, ["q1_rad", "q2"], {"q1_rad": "deg", "q2": "furlong"})
    assert header.unit("q1_rad", ANGLE).name == "deg"
    with pytest.raises(DataError, match="column 'q2' is in 'furlong', expected one of rad"):
        header.unit("q2", ANGLE)


def test_doubled_names_matter_only_where_they_are_wanted():
    header = Header(FILE, ["t", "x", "x"])
    assert header.match("t", ("time",)) == "t"
    with pytest.raises(DataError, match="column 'x' is there 2 times"):
        header.match("x", ANGLE)


@pytest.mark.parametrize(
    ("wanted", "meant"), [("q1", "Q1"), ("tau_1", "tau1"), ("velocity", None), ("p", "p [counts]")]
)
def test_the_name_that_was_meant(wanted, meant):
    assert Header(FILE, ["Q1", "tau1", "p [counts]"]).nearest(wanted) == meant


def test_of_several_columns_that_are_meant_the_first_is_named():
    assert Header(FILE, ["p [mm]", "p [counts]"]).nearest("p") == "p [mm]"
