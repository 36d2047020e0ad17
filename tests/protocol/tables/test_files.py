"""Files and folders."""

import pytest

from limbcal.errors import DataError
from protocol.tables.files import expand


def test_a_folder_stands_for_its_data_files_in_name_order(tmp_path):
    other = tmp_path / "of another day.csv"
    folder = tmp_path / "day"
    folder.mkdir()
    for name in ("b.csv", "a.NPZ", "c.txt", "d.mcap"):
        (folder / name).touch()
    other.touch()
    assert [file.name for file in expand([other, folder])] == [other.name, "a.NPZ", "b.csv", "d.mcap"]


def test_a_file_that_is_named_twice_would_count_twice(tmp_path):
    file, link = tmp_path / "b.csv", tmp_path / "link.csv"
    file.touch()
    link.symlink_to(file)
    for sources in ([file, file], [file, tmp_path / "x" / ".." / "b.csv"], [link, file]):
        (tmp_path / "x").mkdir(exist_ok=True)
        with pytest.raises(DataError, match=r"\.csv is named twice, or itself and with its folder"):
            expand(sources)
    link.unlink()
    with pytest.raises(DataError, match=r"b\.csv is named twice"):
        expand([file, tmp_path])


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
