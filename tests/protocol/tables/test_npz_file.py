"""NPZ: arrays by name, of which only those that are wanted are touched."""

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
