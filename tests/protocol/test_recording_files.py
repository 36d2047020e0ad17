"""The files of one recording are found from any of them, and no others."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.recording_files import files_of, number_of, numbered


def test_all_files_of_a_recording_in_their_order(tmp_path):
    first = tmp_path / "lab-arm-20261125T033227Z-c3230042.mcap"
    mine = [first, *(numbered(first, number) for number in (2, 3, 999, 1000))]
    others = ["lab-arm-20261125T033227Z-c3230043.mcap", "lab-arm-20261125T033227Z-c3230042-002.mcap.part"]
    for path in (*reversed(mine), *(tmp_path / name for name in others)):
        path.touch()
    for path in mine:
        assert files_of(path) == mine
    first.unlink()
    assert files_of(mine[2]) == mine[1:]


@pytest.mark.parametrize(
    ("there", "asked", "found"),
    [
        (["day"], "day", ["day"]),
        (["day", "day-002", "day-004"], "day", ["day", "day-002", "day-004"]),
        (["day-002", "day-004"], "day-004", ["day-002", "day-004"]),
        (["day", "day-001", "day-002"], "day", ["day", "day-002"]),
        (["day", "day-001", "day-002"], "day-001", ["day-001"]),
        (["arm-123", "arm-123-002"], "arm-123", ["arm-123", "arm-123-002"]),
        (["arm-123", "arm-123-002", "arm"], "arm-123-002", ["arm-123", "arm-123-002"]),
        (["arm-12", "arm-12-002", "arm"], "arm-12", ["arm-12", "arm-12-002"]),
        (["arm-1234", "arm-1234-002", "arm"], "arm-1234", ["arm-1234", "arm-1234-002"]),
        (["arm-new", "arm-new-002", "arm"], "arm-new", ["arm-new", "arm-new-002"]),
    ],
)
def test_files_of_one_recording_by_their_names(tmp_path, there, asked, found):
    for name in there:
        (tmp_path / f"{name}.mcap").touch()
    assert files_of(tmp_path / f"{asked}.mcap") == [tmp_path / f"{name}.mcap" for name in found]


def test_a_folder_that_is_not_there_holds_none(tmp_path):
    assert files_of(tmp_path / "gone" / "x.mcap") == []


@given(st.integers(2, 100_000))
def test_numbers_of_any_length_are_told_apart_from_names(tmp_path_factory, number):
    folder = tmp_path_factory.mktemp("files")
    path = numbered(folder / "arm-12345678.mcap", number)
    path.touch()
    assert files_of(path) == [path]
    assert (number_of(path), number_of(folder / "arm-12345678.mcap")) == (number, 1)
