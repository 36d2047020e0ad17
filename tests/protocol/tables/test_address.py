"""The way through a tree of names, lists and arrays, step by step."""

from typing import Any

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.address import head_of, last_name, reached, row_of

TREE: dict[str, Any] = {
    "t": np.arange(3.0),
    "wide": np.arange(6.0).reshape(2, 3),
    "high": np.arange(6.0).reshape(3, 2),
    "gains": np.array([[7.0, 8.0]]),
    "runs": [{"q": np.array([1.0, 2.0])}, {"q": np.array([3.0])}],
    "one[1]": np.array([9.0]),
    "robot": {"arm": {"q": np.array([5.0])}},
}


@pytest.mark.parametrize(
    ("address", "found"),
    [
        ("t", [0.0, 1.0, 2.0]),
        ("wide[2]", [3.0, 4.0, 5.0]),
        ("high[2]", [1.0, 3.0, 5.0]),  # the longer side is time
        ("runs(2).q", [3.0]),
        ("runs(join).q", [1.0, 2.0, 3.0]),
        ("runs(join 2:).q", [3.0]),
        ("one[1]", [9.0]),  # a name as it stands goes before what it could mean
        ("robot.arm.q", [5.0]),
    ],
)
def test_an_address_leads_to_a_row(address: str, found: list[float]) -> None:
    node = reached(TREE, address, "file")
    assert row_of(node, "file").tolist() == found


def test_without_a_number_cells_are_a_list() -> None:
    cells = reached(TREE, "runs(1:2).q", "file")
    assert isinstance(cells, list)
    assert [row_of(cell, "file").tolist() for cell in cells] == [[1.0, 2.0], [3.0]]


def test_a_row_of_gains_has_numbers_that_stand_alone() -> None:
    one = reached(TREE, "gains[2]", "file", is_row=True)
    assert row_of(one, "file", may_be_one=True).tolist() == [8.0]
    with pytest.raises(DataError, match=r"file: \[3\] of a row of 2 numbers, expected 1 to 2"):
        reached(TREE, "gains[3]", "file", is_row=True)


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("", "expected the name of an array first"),
        ("[1]", "expected the name of an array first"),
        ("q", "there is no 'q', expected one of t, wide"),
        ("t.x", "there is no 'x', expected an array, for it has no fields"),
        ("t[1]", r"\[1\] of something with shape \(3,\), expected a table"),
        ("wide[3]", r"\[3\] of a table with 2 rows, expected 1 to 2"),
        ("wide[0]", r"\[0\] of a table with 2 rows"),
        ("wide[x]", "'x' is no index"),
        ("runs(3)", r"\(3\) of something with 2 cells, expected 1 to 2"),
        ("t(1)", r"\(1\) of something with no cells"),
        ("t(1:2)", r"\(1:2\) of something with no cells"),
        ("runs(2:3)", r"\(2:3\) of something with 2 cells, expected some of them"),
        ("t}", "cannot read '}'"),
    ],
)
def test_an_address_that_leads_nowhere_is_said(address: str, said: str) -> None:
    with pytest.raises(DataError, match=f"file: {said}"):
        reached(TREE, address, "file")


@pytest.mark.parametrize(
    ("node", "said"),
    [
        ({"q": np.zeros(2)}, "holds fields or cells"),
        ([np.zeros(2)], "holds fields or cells"),
        (np.float64(1.0).reshape(()), r"has shape \(\)"),
        (np.zeros((2, 3)), r"has shape \(2, 3\), expected a row of numbers"),
    ],
)
def test_what_is_no_row_is_said(node: Any, said: str) -> None:
    with pytest.raises(DataError, match=said):
        row_of(np.asarray(node) if isinstance(node, np.generic) else node, "file")


@pytest.mark.parametrize(
    ("address", "head", "last"),
    [("a.b[2].c", "a", "c"), ("a[2]", "a", "a"), ("a(1:2)", "a", "a"), ("[1]", "", "[1]")],
)
def test_names_of_an_address(address: str, head: str, last: str) -> None:
    assert (head_of(address), last_name(address)) == (head, last)
