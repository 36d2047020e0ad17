"""Files and folders."""

import pytest

from limbcal.errors import DataError
from protocol.tables.files import expand


def test_a_folder_stands_for_its_data_files_in_name_order(tmp_path):
    for name in ("b.csv", "a.NPZ", "c.txt", "d.mcap"):
        (tmp_path / name).touch()
    single = tmp_path / "b.csv"
    assert [file.name for file in expand([single, tmp_path])] == ["b.csv", "a.NPZ", "b.csv", "d.mcap"]


def test_what_is_no_source(tmp_path):
    (tmp_path / "notes.txt").touch()
    with pytest.raises(DataError, match="there is no such file or folder"):
        expand([tmp_path / "none.csv"])
    with pytest.raises(DataError, match="suffix is '.txt', expected one of .csv"):
        expand([tmp_path / "notes.txt"])
    with pytest.raises(DataError, match="no data file in this folder"):
        expand([tmp_path])
    with pytest.raises(DataError, match="at least one"):
        expand([])
