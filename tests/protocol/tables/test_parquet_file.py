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


def test_a_trial_without_a_name_has_an_empty_one(tmp_path):
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pa.table({"a": [1.0, 2.0, 3.0], "trial": ["x", None, "7"]}), path)
    (rows,) = ParquetFile(path).read({"x": [Column("a")]}, "trial")
    assert rows.labels is not None and rows.labels.tolist() == ["x", "", "7"]


def test_in_blocks_rows_are_counted_on(tmp_path):
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pa.table({"a": [0.0, 1.0, 2.0, 3.0, None]}), path)
    found = ParquetFile(path).blocks({"x": [Column("a")]}, None, 2)
    assert [next(found).groups["x"][:, 0].tolist() for _ in range(2)] == [[0.0, 1.0], [2.0, 3.0]]
    with pytest.raises(DataError, match="column 'a', row 5: found nothing or NaN"):
        next(found)


@pytest.mark.parametrize("statistics", [True, False])
def test_a_value_in_any_row_group_is_one(tmp_path, statistics):
    path = tmp_path / "run.parquet"
    columns = {"late": pa.array([None, None, 1.0]), "never": pa.array([None] * 3, pa.float64()), "b": [1.0] * 3}
    pyarrow.parquet.write_table(pa.table(columns), path, row_group_size=1, write_statistics=statistics)
    file = ParquetFile(path)
    assert [file.is_blank(name) for name in ("late", "never", "b")] == [False, True, False]
    pyarrow.parquet.write_table(pa.table({"a": pa.array([], pa.float64())}), path)
    assert not ParquetFile(path).is_blank("a")  # no row is no row of nothing
