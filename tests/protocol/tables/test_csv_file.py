"""CSV, good and bad."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping
from protocol.tables.csv_file import CsvFile
from protocol.tables.reader import read_table_blocks
from protocol.tables.source import Column


def csv(tmp_path, text, name="run.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def numbers(path, *names):
    return CsvFile(path).read({"x": [Column(name) for name in names]}, None)[0].groups["x"]


def test_a_column_that_begins_with_whole_numbers_may_go_on_with_others(tmp_path):
    text = "".join(f"{k},{2**53 - 1 if k == 300 else k}\n{k + 0.5},{k + 0.25}\n" for k in (300, 400))
    path = csv(tmp_path, "t,x\n" + text)
    assert numbers(path, "t").ravel().tolist() == [300.0, 300.5, 400.0, 400.5]
    assert numbers(path, "x").ravel().tolist() == [2.0**53 - 1.0, 300.25, 400.0, 400.25]


def test_only_wanted_columns_are_read(tmp_path):
    path = csv(tmp_path, "t,q1,remark\n0,1.5,ok\n1,-2e-3,not so\n")
    assert numbers(path, "q1", "t").tolist() == [[1.5, 0.0], [-2e-3, 1.0]]


@pytest.mark.parametrize(
    "text",
    [
        "a;b\n1;2\n",
        "a\tb\n1\t2\n",
        ' a , "b" \n 1, 2 \n',
        "// by a device\n\n# of theirs\na,b\n1,2\n",
        "\ufeffa,b\r\n1,2\r\n\r\n",
    ],
)
def test_what_other_programs_write(tmp_path, text):
    assert numbers(csv(tmp_path, text), "a", "b").tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "empty"),
        ("// only a remark\n", "empty"),
        ("0.0,1.0\n1.0,2.0\n", "names of columns"),
        ("a,b\n1,2\n3,NaN\n", "column 'b', row 2: found nothing or NaN"),
        ("a,b\n1,2\n3,\n", "column 'b', row 2: found nothing or NaN"),
        ("a,b\n1,2\n3,4\n-inf,5\n", "column 'a', row 3: found -inf"),
        ("a,b\n1,2\n3,four\n", "row 2: column 'b' holds 'four', expected a number"),
        ("// hm\na,b\n1,2\n3,four\n", "row 2: column 'b' holds 'four', expected a number"),
        ("a,b\n1,2\n3\n", "row 2: 1 cells, expected 2"),
    ],
)
def test_what_is_wrong_is_said_with_column_and_row(tmp_path, text, said):
    path = csv(tmp_path, text)
    with pytest.raises(DataError) as caught:
        numbers(path, "a", "b")
    assert said in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_header_without_rows_has_no_rows(tmp_path):
    assert numbers(csv(tmp_path, "a,b\n"), "a", "b").shape == (0, 2)


def test_bytes_that_are_no_text(tmp_path):
    path = tmp_path / "run.csv"
    path.write_bytes(b"a,b\n\xff\xfe,1\n")
    with pytest.raises(DataError, match="run.csv"):
        numbers(path, "a", "b")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(DataError, match="there is no such file"):
        CsvFile(tmp_path / "none.csv")


def test_labels_come_as_text_beside_numbers(tmp_path):
    path = csv(tmp_path, "trial,a\nfirst,1\n02,2\n")
    (table,) = CsvFile(path).read({"x": [Column("a")], "again": [Column("a")]}, "trial")
    assert table.labels.tolist() == ["first", "02"]
    assert np.array_equal(table.groups["x"], table.groups["again"])


def test_a_long_file_comes_block_by_block(tmp_path):
    path = tmp_path / "long.csv"
    n = 200_000
    path.write_text("t,q1\n" + "".join(f"{0.001 * k:.3f},{k}\n" for k in range(n)), encoding="utf-8")
    tables = list(read_table_blocks(path, 1, parse_mapping("", 1), ("q",), None, 1000))
    assert len(tables) > 2
    assert max(len(table.groups["t"]) for table in tables) <= n // 2
    np.testing.assert_array_equal(np.concatenate([table.groups["q"] for table in tables])[:, 0], np.arange(n))


def test_a_file_that_cannot_be_read(tmp_path):
    folder = tmp_path / "folder.csv"
    folder.mkdir()
    with pytest.raises(DataError, match=r"folder\.csv: cannot be read \(Is a directory\)"):
        CsvFile(folder)
