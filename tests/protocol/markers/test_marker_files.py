"""Recordings read and looked through, as they come."""

from dataclasses import replace

import numpy as np
import pytest

from limbcal.errors import ConfigError
from protocol.markers.marker_files import look_at, read_markers
from tests.protocol.markers.figure import walking


def test_a_clean_recording_has_no_note_and_is_in_metres():
    raw = walking()
    (one,) = look_at([replace(raw, unit="mm", points=1e3 * raw.points)])
    assert one.notes == () and one.recording.up == "+z"
    np.testing.assert_allclose(one.recording.positions, raw.points)


def test_several_damages_are_all_said():
    raw = walking()
    raw.points[100:200, [0, 9]] = raw.points[100:200, [9, 0]]
    raw.points[300:350, 5] = 0.0
    (one,) = look_at([replace(raw, labels=tuple(f"S:{label}" for label in raw.labels), unit="mm", up="+x")])
    assert {note.kind for note in one.notes} == {"prefix", "unit", "up", "zeros", "swapped"}
    assert one.recording.names == raw.labels


def test_who_does_not_stand_has_up_as_others_with_the_same_header_do():
    standing = replace(walking(), up="-z")
    crouching = replace(standing, path="low.trc", points=standing.points * [8.0, 8.0, 1.0])
    alone, both = look_at([crouching]), look_at([standing, crouching])
    assert [one.recording.up for one in (*alone, *both)] == ["-z", "+z", "+z"]
    assert "in other files of this call persons stand along +z" in both[1].notes[-1].text


def test_without_a_header_who_does_not_stand_has_up_as_who_does():
    standing = replace(walking(), up="")
    sitting = replace(standing, path="low.trc", points=standing.points * [8.0, 8.0, 1.0])
    assert [one.recording.up for one in look_at([sitting])] == [""]
    both = look_at([standing, sitting])
    assert [one.recording.up for one in both] == ["+z", "+z"] and both[0].notes == ()
    assert "nothing tells which axis points up, but in other files" in both[1].notes[-1].text


def test_measured_recordings_have_no_exchanged_labels(measured_data):
    for folder in ("kineticstoolkit", "biobuddy", "btk"):
        files = [file for file in sorted((measured_data / folder).glob("*.c3d")) if file.stem != "sprintbasket"]
        assert not [note.text for one in read_markers(files) for note in one.notes if note.kind == "swapped"]


def test_an_exchange_in_a_measured_recording_is_put_right(measured_data):
    """Two of a forearm, one of which leaps onto the other's place: as they are, one would be 64 mm up the bone."""
    names = [f"ForearmL:Marker{k}" for k in (1, 4)]
    (one,) = read_markers([measured_data / "kineticstoolkit" / "sprintbasket.c3d"])
    notes = [note for note in one.notes if note.kind == "swapped"]
    assert all(set(note.columns) == set(names) for note in notes)
    assert [(note.from_s, note.to_s) for note in notes] == [
        (pytest.approx(5.7), pytest.approx(6.1)),
        (pytest.approx(1036 / 120), pytest.approx(1038 / 120)),
    ]
    from_elbow = one.recording.of(names) - one.recording.of(["LateralEpicondyleL"])
    near, far = np.linalg.norm(from_elbow[684:1038], axis=2).T
    assert np.nanmax(np.abs(near - 0.207)) < 0.01 and np.nanmax(np.abs(far - 0.270)) < 0.01


def test_a_file_of_another_kind_is_refused_by_its_name(tmp_path):
    for name, said in (("a.csv", r"\.csv, expected \.c3d or \.trc"), ("a.trc", "No such file")):
        with pytest.raises(ConfigError, match=said):
            read_markers([tmp_path / name])
