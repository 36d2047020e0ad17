"""How a text is written, recognised by its beginning."""

import codecs
from pathlib import Path

import pytest

from limbcal.errors import DataError
from protocol.tables.dialect import HEAD_BYTES, dialect_of, encoding_of, is_stamp, is_value, split_cells

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


def test_the_last_remark_or_the_two_last_are_the_header_whatever_stands_above():
    for above in ("", "# by us\n", "# by us\n# in May\n"):
        assert dialect(f"{above}# a b\n1 2\n").names == ("a", "b")
        found = dialect(f"{above}# a b\n# s rad\n1 2\n")
        assert found.names == ("a", "b") and found.units == {"a": "s", "b": "rad"}


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


def of(text, encoding="utf-8"):
    return dialect_of(text.encode(encoding), encoding, FILE)


def first_row(text, encoding="utf-8"):
    head = text.encode(encoding)
    found = dialect_of(head, encoding, FILE)
    return head[found.start :].decode(encoding).split("\n")[0]


@pytest.mark.parametrize(
    ("head", "encoding"),
    [
        (b"", "utf-8"),
        ("é".encode()[:1], "utf-8"),  # cut within a character
        (b"t,q\x81\n", "latin-1"),  # no character of cp1252
        (b"t,q1\n1,2\n" + bytes(500), "utf-8"),  # a disk that lost power
        ("t\n€€€€€€€€€€€€€€€".encode("utf-16-le"), "cp1252"),  # too few zeros for text in Latin script
        ("t,q1\n0.1,€\n".encode("utf-16-be"), "utf-16-be"),
        ("t,q1\n0.1,€\n".encode("utf-16-le"), "utf-16-le"),
        (codecs.BOM_UTF16_BE + "t".encode("utf-16-be"), "utf-16"),
        (codecs.BOM_UTF8 + b"t", "utf-8-sig"),
    ],
)
def test_bytes_tell_their_encoding(head, encoding):
    assert encoding_of(head) == encoding


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_rows_begin_where_the_first_one_is(encoding):
    text = "# remark\n\nt;q1\n# [s];[rad]\n0,5;1,5\n0,6;2,5\n"
    head = text.encode(encoding)
    found = dialect_of(head, encoding, FILE)
    assert head[found.start :] == b"0,5;1,5\n0,6;2,5\n"
    assert (found.units, found.decimal, found.sample[1]) == ({"t": "[s]", "q1": "[rad]"}, ",", ("0,6", "2,5"))
    only = of("t;q1\n")
    assert (only.names, only.sample, only.start) == (("t", "q1"), (), 5)


def test_a_remark_between_rows_holds_no_units():
    assert of("t,q1\n0,1\n# [s],[rad]\n1,2\n").units == {}
    assert of("# [ms],[deg]\nt,q1\n0,1\n").units == {}
    assert of("t,q1\n# made today, by hand\n# [s],[rad]\n0,1\n").units == {"t": "[s]", "q1": "[rad]"}


def test_a_row_of_units_may_leave_some_out():
    assert of("t,q1,trial\ns,deg,\n0,1,2\n").units == {"t": "s", "q1": "deg"}
    assert of("t,q1\n[s],[furlong]\n0,1\n").units == {"t": "[s]", "q1": "[furlong]"}
    assert of("t,q1,dq1\ns,red,blue\n0,1,2\n").units == {}  # most of it is none


def test_a_comma_is_a_decimal_sign_where_no_point_is():
    assert of("t;q1\n0;1,5\n").decimal == ","
    assert of("t;q1\n0.5;1,5\n").decimal == "."
    assert of("t;q1\n0;1\n").decimal == "."
    assert of("t;q1\n-0,5e-3;,5\n").decimal == ","


@pytest.mark.parametrize(("line", "delimiter"), [("sep=;", ";"), ("SEP=,", ","), ("sep=|", "|"), ("sep=\t", "\t")])
def test_the_line_that_says_what_parts_cells_is_obeyed(line, delimiter):
    found = of(f"{line}\nt{delimiter}q1\n0{delimiter}1\n")
    assert (found.delimiter, found.names, found.start) == (delimiter, ("t", "q1"), len(line) + 6)
    assert of("sep=;\nt,x;q1\n0;1\n").names == ("t,x", "q1")


def test_a_name_may_have_a_line_s_end_in_it():
    found = of('"time\n[s]",q1\n0,1\n')
    assert len(found.names) == 2 and found.names[1] == "q1" and found.sample == (("0", "1"),)


@pytest.mark.parametrize(("before", "found"), [(0, 0), (1, 1), (63, 63), (64, None)])
def test_a_header_is_looked_for_behind_some_lines_of_text(before, found):
    text = (
        "".join(f"about {'so ' * (k % 3)}{k}\n" for k in range(before))
        + "time,angle\n"
        + "".join(f"{k},{k}\n" for k in range(9))
    )
    if found is None:
        assert of(text).names != ("time", "angle")
    else:
        assert (of(text).names, of(text).preamble, first_row(text)) == (("time", "angle"), found, "0,0")


def test_names_behind_text_stand_above_numbers():
    numbers = "a,b\n0.1,1\n0.2,2\n0.3,3\n0.4,4\n"
    assert of("Export,of today\nby,hand\n" + numbers).preamble == 0  # as many cells: the first line is the header
    assert of("Export\n" + numbers).preamble == 1
    assert of("Export\n1,2\n3,4\n5,6\n7,8\n").preamble == 0  # numbers are no names
    assert of("Export\na,b\nc,d\ne,f\n").preamble == 0  # nor do names stand above names


def test_the_last_line_may_be_cut_and_the_others_may_not():
    assert of("t,q1,q2\n0,1,2\n1,2,3\n2,3").delimiter == ","
    assert of("a b,c d,e f\n0 1,2,3\n1 2,3").names == ("a b", "c d", "e f")
    assert of("t;q1,5;q2\n0;1,5;2\n1;2,5;3\n2;3").delimiter == ";"
    assert of("t;x,y,z\n0;1\n1;2\n2").names == ("t", "x,y,z")


def test_where_rows_fit_no_header_its_own_line_says_what_parts_cells():
    assert of("a;b;c\n1,2,3,4,5\n").names == ("a", "b", "c")


def test_numbers_beside_a_unit_are_a_row():
    found = of("t,unit\n0.1,deg\n0.2,deg\n")
    assert found.units == {} and found.sample == (("0.1", "deg"), ("0.2", "deg"))


def test_a_row_may_have_empty_cells_that_the_header_has_not():
    assert of("t,q1\n0,1,,\n1,2,,\n").names == ("t", "q1", "", "")
    assert of("t,q1,,\n0,1\n1,2\n").names == ("t", "q1")
    assert of("t,q1\n0,1,7\n1,2,8\n").names == ("t", "q1")  # that is no table, as is said later


@pytest.mark.parametrize(
    ("text", "names", "delimiter"),
    [
        ("# t,q1\n0.0,1.0\n", ("t", "q1"), ","),
        ("% t q1\n0.0 1.0\n", ("t", "q1"), " "),
        ("# t,q1\n0.0 1.0\n", ("t", "q1"), " "),  # names parted by something else
        ("# of today\n# t,q1\n0.0,1.0\n", ("t", "q1"), ","),
        ("# t,q1\n# s,rad\n0.0,1.0\n", ("t", "q1"), ","),
        ("# t\n0.0\n1.0\n", ("t",), "\t"),
    ],
)
def test_a_header_may_be_a_remark(text, names, delimiter):
    found = of(text)
    assert (found.names, found.delimiter) == (names, delimiter)
    assert found.units == ({"t": "s", "q1": "rad"} if "s,rad" in text else {})


@pytest.mark.parametrize("text", ["# 1,2\n0,1\n", "# t,,q\n0,1,2\n", "0,1\n1,2\n"])
def test_a_remark_that_names_nothing_is_no_header(text):
    with pytest.raises(DataError, match="expected names of columns"):
        of(text)


def test_of_a_long_file_the_line_that_goes_on_is_left_out():
    row = "0.123,4.567\n"
    head = ("t,q1\n" + row * (HEAD_BYTES // len(row) + 1)).encode()[:HEAD_BYTES]
    whole = head.decode().splitlines()[1:-1]
    assert len(dialect_of(head, "utf-8", FILE).sample) == len(whole)
    assert len(dialect_of(head[:-1], "utf-8", FILE).sample) == len(whole) + 1  # all there is of a short one


def test_blanks_and_quotes_are_taken_off_cells():
    assert split_cells(' "a, b" ,  c ,d\r\n', ",") == ["a, b", "c", "d"]
    assert split_cells("  a \t b\n", " ") == ["a", "b"]
    assert split_cells("a\tb\n", "\t") == ["a", "b"]
    assert of("'t','q1'\n0,1\n").names == ("t", "q1")
    assert of("t,q1\n0,1\n").cells("a, b") == ["a", "b"]


@pytest.mark.parametrize("cell", ["2024-05-01T12:30", "2024-05-01 12:30:15,5Z", " 2024-05-01T12:30:15.25+02:00 "])
def test_a_stamp_is_a_value(cell):
    assert is_stamp(cell) and is_value(cell, ".") and is_value(cell, ",")
    assert not is_stamp("2024-05-01") and not is_value("12:30", ".")
    assert is_value("1,5", ",") and not is_value("1,5", ".") and is_value("1,5", "")


@pytest.mark.parametrize(("rows", "preamble"), [("0,1\n", 0), ("0,1\n1,2\n", 0), ("0,1\n1,2\n2,3\n", 1)])
def test_names_behind_text_need_two_rows_besides_the_last(rows, preamble):
    assert of("Export\nt,q\n" + rows).preamble == preamble
