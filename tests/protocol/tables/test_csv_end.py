"""Where the last whole row of a text ends."""

from pathlib import Path

import pyarrow as pa
import pytest

from protocol.tables.csv_end import last_row_end
from protocol.tables.dialect import dialect_of

FILE = Path("run.csv")
WHOLE = "a,b\n" + "".join(f"{k}.00,{k}.50\n" for k in range(10, 99))


def end(text):
    content = text.encode()
    stop, notes = last_row_end(pa.py_buffer(content), dialect_of(content, "utf-8", FILE), FILE)
    return content[:stop], [note.text for note in notes]


@pytest.mark.parametrize("more", ["", "\n", "\n\n", ",\n,\n", " \n", "\0\0\0"])
def test_a_whole_text_ends_with_its_last_row(more):
    assert end(WHOLE + more) == (WHOLE.encode(), [])


def test_a_last_line_without_an_end_is_whole_if_it_looks_so():
    assert end(WHOLE.rstrip("\n")) == (WHOLE.rstrip("\n").encode(), [])


@pytest.mark.parametrize(("more", "said"), [("9", "1 of 2 cells"), ("99.00,", "2 of 2"), ("99.00,-", "2 of 2")])
def test_a_last_line_that_was_cut_is_left_out(more, said):
    kept, (note,) = end(WHOLE + more)
    assert kept == WHOLE.encode() and said in note


def test_a_number_that_was_cut_is_shorter_than_all_before_it():
    kept, (note,) = end(WHOLE + "99.00,99")
    assert kept == WHOLE.encode() and "within a number" in note
    assert end("a,b\n1.00,1.50\n2.00,2") == (b"a,b\n1.00,1.50\n2.00,2", [])


def test_the_last_number_is_compared_with_those_of_its_own_column():
    whole = "a,b,c\n" + "".join(f"{k}.00000,{k},{k}.50\n" for k in range(10, 99))
    kept, (note,) = end(whole + "99.00000,99,99.")
    assert kept == whole.encode() and "within a number" in note
