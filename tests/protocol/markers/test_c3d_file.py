"""C3D files: written by ezc3d, measured by others, and none at all."""

import ezc3d
import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.markers.c3d_file import read_c3d


@pytest.fixture
def written(tmp_path):
    """Return a file with two markers, one of which is not seen for a while, and an angle."""
    file = ezc3d.c3d()
    points = np.ones((4, 3, 20))
    points[:3] = np.arange(20)
    points[:3, 1, 5:8] = np.nan
    file["parameters"]["POINT"]["RATE"]["value"] = [50.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["S:A", "S:B", "S:KneeAngles"]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    file.add_parameter("POINT", "ANGLES", ["S:KneeAngles"])
    file["data"]["points"] = points
    path = tmp_path / "some.c3d"
    file.write(str(path))
    return path


def test_labels_rate_unit_and_gaps_are_read(written):
    raw = read_c3d(written)
    assert (raw.labels, raw.rate_hz, raw.unit) == (("S:A", "S:B", "S:KneeAngles"), 50.0, "mm")
    assert raw.computed == {"S:KneeAngles"}
    assert raw.points.shape == (20, 3, 3)
    np.testing.assert_array_equal(np.isnan(raw.points[:, 1, 0]), (np.arange(20) >= 5) & (np.arange(20) < 8))


def test_frames_that_a_file_lacks_are_known(written):
    assert read_c3d(written).stated_frames == 20
    data = written.read_bytes()
    cut = written.with_name("cut.c3d")
    cut.write_bytes(data[:-600])
    raw = read_c3d(cut)
    assert raw.stated_frames == 20 > len(raw.points)


def test_what_is_no_c3d_file_is_one_sentence(tmp_path):
    path = tmp_path / "no.c3d"
    for content in (b"", b"PathFileType", b"\x02\x50" + bytes(1000)):
        path.write_bytes(content)
        with pytest.raises(DataError, match=r"no\.c3d: "):
            read_c3d(path)


def test_a_damaged_count_is_refused_at_once(written):
    data = bytearray(written.read_bytes())
    dimensions = data.index(b"LABELS") + len("LABELS") + 3  # behind an offset of two bytes, and the type
    data[dimensions : dimensions + 6] = b"\x05" + b"\xff" * 5
    written.write_bytes(bytes(data))
    with pytest.raises(DataError, match="cannot be read: a count in it asks for more memory"):
        read_c3d(written)


def test_platforms_are_read_without_a_calibration_matrix(measured_data):
    raw = read_c3d(measured_data / "biobuddy" / "right_knee.c3d")
    assert [(force.name, force.rate_hz) for force in raw.forces] == [("plate 1", 2000.0), ("plate 2", 2000.0)]
    assert all(len(force.channels) == 20 * len(raw.points) for force in raw.forces)
