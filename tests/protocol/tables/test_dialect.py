"""How a text is written, told from its beginning."""

from pathlib import Path

import pytest

from limbcal.errors import DataError
from protocol.tables.dialect import dialect_of, encoding_of, is_stamp, split_cells

FILE = Path("run.csv")


def dialect(text):
    return dialect_of(text.encode(), "utf-8", FILE)


@pytest.mark.parametrize(
    ("text", "delimiter", "decimal", "names"),
    [
        ("a,b\n0.5,1\n", ",", ".", ("a", "b")),
        ("a;b\n0,5;1\n", ";", ",", ("a", "b")),
        ("a;b\n0.5;1,2\n", ";", ".", ("a", "b")),
        ("a\tb\n0,5\t1\n", "\t", ",", ("a", "b")),
        ("Zeit, s;Winkel, rad\n0,5;1,5\n", ";", ",", ("Zeit, s", "Winkel, rad")),
        ("# a b\n1 2\n", " ", ".", ("a", "b")),
        ("a\n1\n2\n", ",", ".", ("a",)),
        ("text\n\nmore, text\na,b,c\n1,2,3\n4,5,6\n7,8,9\n", ",", ".", ("a", "b", "c")),
    ],
)
def test_what_parts_cells_and_numbers(text, delimiter, decimal, names):
    found = dialect(text)
    assert (found.delimiter, found.decimal, found.names) == (delimiter, decimal, names)


def test_rows_begin_behind_the_header_its_units_and_remarks():
    text = "# by us\na,b\ns,rad\n# more\n1,2\n"
    found = dialect(text)
    assert text.encode()[found.start :] == b"1,2\n" and found.units == {"a": "s", "b": "rad"}
    assert dialect("x\ny\na,b\n1,2\n3,4\n5,6\n").preamble == 2


@pytest.mark.parametrize(
    ("text", "said"), [("1,2\n3,4\n", "the first row is '1,2'"), ("# a\n", "the file is empty")]
)
def test_without_names_there_is_no_table(text, said):
    with pytest.raises(DataError, match=f"run.csv: {said}"):
        dialect(text)


@pytest.mark.parametrize(
    ("head", "encoding"),
    [
        ("Größe".encode(), "utf-8"),
        ("Größe".encode("utf-8-sig"), "utf-8-sig"),
        ("Größe".encode("cp1252"), "cp1252"),
        ("Größe".encode("utf-16"), "utf-16"),
        ("t,q1\n".encode("utf-16-be"), "utf-16-be"),
        (b"t,q1\n" + bytes(4096), "utf-8"),
        (b"\x81\xff", "latin-1"),
    ],
)
def test_encodings(head, encoding):
    assert encoding_of(head) == encoding


def test_cells_and_stamps():
    assert split_cells(' a , "b, c" ,,"d ""e"""', ",") == ["a", "b, c", "", 'd "e"']
    assert is_stamp("2026-03-01T12:00:00.25Z") and is_stamp("2026-03-01 12:00") and not is_stamp("12:00:00")
