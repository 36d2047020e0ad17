"""NPZ: arrays by name, of which only those that are wanted are touched."""

import io
import zipfile

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.npz_file import NpzFile
from protocol.tables.source import Column


def test_npz_holds_arrays_by_name(tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(3), q=np.arange(6.0).reshape(3, 2), trial=np.array(["a", "a", "b"]))
    (table,) = NpzFile(path).read({"x": [Column("t"), Column("q[2]")]}, "trial")
    assert table.groups["x"].tolist() == [[0, 1], [1, 3], [2, 5]]
    assert table.labels.tolist() == ["a", "a", "b"]


def test_nothing_is_unpickled_and_what_is_not_wanted_is_not_looked_at(tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(3.0), config=np.array([{"a": 1}], dtype=object), allow_pickle=True)
    source = NpzFile(path)
    assert source.read({"x": [Column("t")]}, None)[0].groups["x"][:, 0].tolist() == [0, 1, 2]
    assert next(source.blocks({"x": [Column("t")]}, None, 10)).groups["x"][:, 0].tolist() == [0, 1, 2]
    with pytest.raises(DataError, match="'config' holds pickled objects, expected numbers"):
        source.read({"x": [Column("config")]}, None)


def test_a_bare_array_is_no_npz(tmp_path):
    path = tmp_path / "run.npz"
    with path.open("wb") as file:
        np.save(file, np.arange(3))
    with pytest.raises(DataError, match="one bare array"):
        NpzFile(path)


@pytest.mark.parametrize("content", [b"", b"no such thing at all", b"PK\x03\x04garbage"])
def test_files_that_are_something_else(tmp_path, content):
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"run\.npz: cannot be read as NPZ"):
        NpzFile(path)


def test_an_array_that_is_there_is_not_blank(tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(3.0), q1=np.zeros(3))
    assert not NpzFile(path).is_blank("q1")


def test_rows_come_in_blocks_with_what_remains_last(tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(5.0), n=np.arange(5, dtype=np.int16), trial=np.array(list("aabbc")))
    source = NpzFile(path)
    groups = {"x": [Column("t"), Column("n", 0.5)]}
    assert source.streams(groups, "trial")
    found = [(rows.groups["x"].tolist(), list(rows.labels)) for rows in source.blocks(groups, "trial", 2)]
    assert found == [
        ([[0.0, 0.0], [1.0, 0.5]], ["a", "a"]),
        ([[2.0, 1.0], [3.0, 1.5]], ["b", "b"]),
        ([[4.0, 2.0]], ["c"]),
    ]


@pytest.mark.parametrize(
    ("other", "streams"),
    [
        (np.arange(3.0), True),
        (np.arange(4.0), False),  # of another length
        (np.zeros((3, 1)), False),  # a table
        (np.array(3.0), False),
        (np.array(["a", "b", "c"]), True),
        (np.zeros(3, complex), False),
    ],
)
def test_only_rows_of_one_length_come_in_blocks(tmp_path, other, streams):
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(3.0), other=other)
    assert NpzFile(path).streams({"x": [Column("t"), Column("other")]}, None) is streams
    assert not NpzFile(path).streams({"x": [Column("nowhere")]}, None)


def test_in_blocks_a_value_that_is_missing_has_its_row(tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, a=np.array([0.0, 1.0, 2.0, np.nan]))
    found = NpzFile(path).blocks({"x": [Column("a")]}, None, 2)
    next(found)
    with pytest.raises(DataError, match="a, row 4: found nothing or NaN"):
        next(found)


@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_arrays_of_any_version_are_read_in_blocks(tmp_path, version):
    path, file = tmp_path / "run.npz", io.BytesIO()
    np.lib.format.write_array(file, np.arange(4.0), version=version)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.npy", file.getvalue())
        archive.writestr("remarks.txt", b"of no interest")
    source = NpzFile(path)
    assert source.names == ("a",)
    (rows,) = source.blocks({"x": [Column("a")]}, None, 10)
    assert rows.groups["x"][:, 0].tolist() == [0.0, 1.0, 2.0, 3.0]
