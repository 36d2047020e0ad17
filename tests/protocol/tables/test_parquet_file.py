"""Parquet, good and bad."""

import pyarrow as pa
import pyarrow.parquet
import pytest

from limbcal.errors import DataError
from protocol.tables.parquet_file import ParquetFile
from protocol.tables.source import Column


def numbers(path, *names):
    return ParquetFile(path).read({"x": [Column(name) for name in names]}, None)[0].groups["x"]


@pytest.mark.parametrize("content", [b"", b"this is no parquet"])
def test_a_parquet_file_that_is_none(tmp_path, content):
    path = tmp_path / "run.parquet"
    path.write_bytes(content)
    with pytest.raises(DataError, match="run.parquet"):
        ParquetFile(path)


def test_parquet_of_any_number_type(tmp_path):
    path = tmp_path / "run.parquet"
    columns = {"a": pa.array([1, 2], pa.int16()), "b": pa.array([0.5, 0.25], pa.float32()), "c": ["x", "y"]}
    pyarrow.parquet.write_table(pa.table(columns), path)
    assert numbers(path, "a", "b").tolist() == [[1.0, 0.5], [2.0, 0.25]]
    with pytest.raises(DataError, match="column 'c' holds string, expected numbers"):
        numbers(path, "c")


def test_a_missing_value_in_parquet(tmp_path):
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pa.table({"a": pa.array([1.0, None])}), path)
    with pytest.raises(DataError, match="column 'a', row 2"):
        numbers(path, "a")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(DataError, match="there is no such file"):
        ParquetFile(tmp_path / "none.parquet")


def test_a_column_without_a_value_is_blank(tmp_path):
    path = tmp_path / "run.parquet"
    columns = {"a": pa.array([None, None], pa.float64()), "b": pa.nulls(2), "c": pa.array([None, 1.0])}
    pyarrow.parquet.write_table(pa.table(columns), path)
    assert [ParquetFile(path).is_blank(name) for name in "abc"] == [True, True, False]


def test_labels_that_are_missing_are_empty_and_others_are_words(tmp_path):
    path = tmp_path / "run.parquet"
    columns = {"a": pa.array([1.0, 2.0, 3.0]), "w": pa.array(["x", None, "y"]), "n": pa.array([7, 8, None])}
    pyarrow.parquet.write_table(pa.table(columns), path)
    groups = {"x": [Column("a")]}
    assert ParquetFile(path).read(groups, "w")[0].labels.tolist() == ["x", "", "y"]
    assert ParquetFile(path).read(groups, "n")[0].labels.tolist() == ["7", "8", ""]


@pytest.mark.parametrize("rows", [1, 2, 3, 100])
def test_blocks_have_the_rows_of_the_whole_and_name_those_of_the_file(tmp_path, rows):
    path = tmp_path / "run.parquet"
    columns = {"a": pa.array([1.0, 2.0, 3.0, 4.0, 5.0]), "b": pa.array([0.0, 0.0, 0.0, None, 0.0])}
    pyarrow.parquet.write_table(pa.table(columns), path)
    file = ParquetFile(path)
    blocks = list(file.blocks({"x": [Column("a", 10.0), Column("a")], "y": [Column("a")]}, "a", rows))
    whole = [row for block in blocks for row in block.groups["x"].tolist()]
    assert whole == [[10.0 * k, float(k)] for k in range(1, 6)]
    assert [len(block.labels) for block in blocks] == [len(block.groups["y"]) for block in blocks]
    assert max(len(block.labels) for block in blocks) == min(rows, 5)
    with pytest.raises(DataError, match="column 'b', row 4"):
        list(file.blocks({"x": [Column("b")]}, None, rows))
    assert file.streams({}, None)


@pytest.mark.parametrize(
    ("values", "blank"),
    [([], False), ([1.0], False), ([None], True), ([None, None, 1.0], False), ([1.0, None], False)],
)
def test_a_column_is_blank_where_it_has_rows_and_no_value(tmp_path, values, blank):
    path = tmp_path / "run.parquet"
    for statistics in (True, False):
        table = pa.table(
            {"a": pa.array(values, pa.float64()), "other": pa.array([2.0] * len(values), pa.float64())}
        )
        pyarrow.parquet.write_table(table, path, write_statistics=statistics)
        assert ParquetFile(path).is_blank("a") == blank
        assert not ParquetFile(path).is_blank("other")


@pytest.mark.parametrize("statistics", [True, False])
def test_a_value_in_any_row_group_is_one(tmp_path, statistics):
    path = tmp_path / "run.parquet"
    columns = {"late": pa.array([None, None, 1.0]), "never": pa.array([None] * 3, pa.float64()), "b": [1.0] * 3}
    pyarrow.parquet.write_table(pa.table(columns), path, row_group_size=1, write_statistics=statistics)
    file = ParquetFile(path)
    assert [file.is_blank(name) for name in ("late", "never", "b")] == [False, True, False]
    pyarrow.parquet.write_table(pa.table({"a": pa.array([], pa.float64())}), path)
    assert not ParquetFile(path).is_blank("a")  # no row is no row of nothing
