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
