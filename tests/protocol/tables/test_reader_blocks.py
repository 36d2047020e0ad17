"""A table as a whole and block by block: the same rows, numbers, times and notes."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping
from protocol.tables.csv_file import CsvFile
from protocol.tables.reader import read_table_blocks, read_tables
from protocol.tables.source import Column

N = 40_000


def file(tmp_path, text, name="run.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def long_file(tmp_path, header="q1", row="{k}"):
    return file(tmp_path, header + "\n" + "".join(row.format(k=k) + " " * 40 + "\n" for k in range(N)))


def blocks_of(path, mapping="", rate_hz=None, rows=1000):
    return list(read_table_blocks(path, 1, parse_mapping(mapping, 1), ("q",), rate_hz, rows))


@pytest.mark.parametrize(("mapping", "rate_hz", "step_s"), [("", 250.0, 0.004), ("t=0.002", None, 0.002)])
def test_rows_without_time_are_counted_on_from_block_to_block(tmp_path, mapping, rate_hz, step_s):
    path = long_file(tmp_path)
    blocks = blocks_of(path, mapping, rate_hz)
    assert len(blocks) > 1
    n = [len(block.groups["t"]) for block in blocks]
    assert [block.first_row for block in blocks] == np.cumsum([0, *n[:-1]]).tolist() and sum(n) == N
    t = np.concatenate([block.groups["t"] for block in blocks])
    np.testing.assert_allclose(t[:, 0], step_s * np.arange(N), rtol=1e-12, atol=0)
    (whole,) = read_tables(path, 1, parse_mapping(mapping, 1), ("q",), rate_hz=rate_hz)
    np.testing.assert_array_equal(whole.groups["t"], t)
    assert whole.first_row == 0 and whole.origin_s == 0.0
    assert ("t" in whole.stated) == ("t" in blocks[1].stated) == (mapping != "")


def test_notes_are_those_of_the_file_and_said_once(tmp_path):
    path = long_file(tmp_path, "t [ms],q1 [deg]", "{k},90")
    blocks = blocks_of(path)
    said = [note.text for note in blocks[0].notes]
    assert said == ["t [ms] is in ms and is converted to s", "q1 [deg] is in deg and is converted to rad"]
    assert not any(block.notes for block in blocks[1:])
    assert all(block.stated == {"t", "q1"} for block in blocks)
    assert blocks[-1].groups["t"][-1, 0] == pytest.approx(1e-3 * (N - 1))
    assert blocks[-1].groups["q"][-1, 0] == pytest.approx(np.pi / 2.0)
    (whole,) = read_tables(path, 1, parse_mapping("", 1), ("q",))
    assert [note.text for note in whole.notes] == said


def test_a_value_that_is_none_is_named_with_its_row_in_a_late_block_too(tmp_path):
    text = "t,q1\n" + "".join(f"{k},{'nan' if k == 30_000 else 1.5}{' ' * 40}\n" for k in range(N))
    with pytest.raises(DataError, match="column 'q1', row 30001: found nothing or NaN"):
        blocks_of(file(tmp_path, text))
    text = text.replace("nan", "four")
    with pytest.raises(DataError, match="row 30001: column 'q1' holds 'four"):
        blocks_of(file(tmp_path, text))


@pytest.mark.parametrize("read", [blocks_of, lambda path: read_tables(path, 1, parse_mapping("", 1), ("q",))])
def test_a_table_without_rows_or_time_is_said(tmp_path, read):
    with pytest.raises(DataError, match="there is a header but no row, expected samples"):
        read(file(tmp_path, "t,q1\n"))
    with pytest.raises(
        DataError, match="no column 't' among its columns q1, expected time stamps, or else the rate"
    ):
        read(file(tmp_path, "q1\n1\n"))


def test_what_is_no_stream_comes_whole(tmp_path):
    path = file(tmp_path, '{"t": [0, 1, 2], "q1": [5, 6, 7]}', "run.json")
    (block,) = blocks_of(path, rows=1)
    assert block.groups["q"].ravel().tolist() == [5.0, 6.0, 7.0] and block.first_row == 0


@pytest.mark.parametrize(
    ("rows", "blank"),
    [
        ("0,,x\n1,,y\n", True),
        ("0, ,x\n1, ,y\n", True),
        ("0,,x\n1,5,y\n", False),
        ("0,0,x\n1,,y\n", False),
        ("", False),
    ],
)
def test_a_column_is_blank_where_no_row_has_a_value(tmp_path, rows, blank):
    assert CsvFile(file(tmp_path, "t,q1,c\n" + rows)).is_blank("q1") == blank


def test_a_late_value_makes_a_column_no_blank(tmp_path):
    text = "t,q1\n" + "".join(f"{k},{'' if k < N - 1 else 7}{' ' * 40}\n" for k in range(N))
    assert not CsvFile(file(tmp_path, text)).is_blank("q1")


def test_remarks_between_rows_are_passed_over_and_blanks_part_cells(tmp_path):
    groups = {"x": [Column("a"), Column("b")]}
    for text in ("a,b\n1,2\n# so far\n3,4\n", "a b\n1  2\n3 \t 4\n", "# a b\n  1 2\n3 4\n"):
        (rows,) = CsvFile(file(tmp_path, text)).read(groups, None)
        assert rows.groups["x"].tolist() == [[1.0, 2.0], [3.0, 4.0]]


@pytest.mark.parametrize(("before", "said"), [(1, "1 line before"), (2, "2 lines before"), (0, None)])
def test_lines_before_the_header_are_counted(tmp_path, before, said):
    path = file(tmp_path, "about this\n" * before + "a,b\n" + "1,2\n3,4\n5,6\n")
    notes = CsvFile(path).notes
    assert [(note.kind, note.text[: len(said or "")]) for note in notes] == ([("preamble", said)] if said else [])


def test_a_label_that_is_not_there_is_empty(tmp_path):
    (rows,) = CsvFile(file(tmp_path, "trial,a\nß,1\n,2\nß,3\n")).read({"x": [Column("a")]}, "trial")
    assert rows.labels.tolist() == ["ß", "", "ß"]


def test_long_whole_stamps_keep_all_their_digits(tmp_path):
    start = 1_700_000_000_000_000_001
    path = file(tmp_path, "t,q1\n" + "".join(f"{start + 250_000 * k},1\n" for k in range(5)))
    (table,) = read_tables(path, 1, parse_mapping("", 1), ("q",))
    np.testing.assert_allclose(
        table.groups["t"][:, 0] - table.groups["t"][0, 0], 2.5e-4 * np.arange(5), atol=1e-12
    )
    assert table.origin_s == pytest.approx(1.7e9)
    assert table.notes[0].text == "t counts ns since 1970, by its size, and is converted to s"
    assert table.notes[1].text == "t is counted from the file's first stamp, 1700000000.000000 s"
