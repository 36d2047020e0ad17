"""A file is there whole or not at all."""

from pathlib import Path

import pytest

from limbcal.errors import DeviceError
from playback.export.whole_file import whole_file


def test_a_file_takes_its_name_once_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "motion.gif"
    with whole_file(path) as part:
        assert (part.parent, part.suffix) == (path.parent, path.suffix)
        part.write_bytes(b"half")
        assert not path.exists()
        part.write_bytes(b"whole")
    assert path.read_bytes() == b"whole"
    assert list(path.parent.iterdir()) == [path]


def test_of_one_that_fails_nothing_is_left_and_the_one_before_stays(tmp_path: Path) -> None:
    path = tmp_path / "motion.gif"
    path.write_bytes(b"before")
    with pytest.raises(KeyError):
        with whole_file(path) as part:
            part.write_bytes(b"half")
            raise KeyError("a fault of the program")
    with pytest.raises(DeviceError, match=f"^{path} cannot be written: disk full$"):
        with whole_file(path) as part:
            part.write_bytes(b"half")
            raise OSError(28, "disk full")
    with pytest.raises(DeviceError, match=f"^{path} cannot be written: no codec$"):
        with whole_file(path):
            raise OSError("no codec")
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_a_file_is_said(tmp_path: Path) -> None:
    (tmp_path / "folder").write_bytes(b"")
    with pytest.raises(DeviceError, match="cannot be written: File exists"):
        with whole_file(tmp_path / "folder" / "motion.gif"):
            pytest.fail("it is written")
