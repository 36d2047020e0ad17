"""TRC files as programs write them, and as they should not be."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.markers.trc_file import read_trc

HEADER = (
    "PathFileType\t4\t(X/Y/Z)\tsomebody.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
    "100\t100\t3\t2\tmm\t100\t1\t3\n"
    "Frame#\tTime\tLASI\t\t\tRASI\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
)
ROWS = "1\t0.00\t1\t2\t3\t4\t5\t6\n2\t0.01\t1\t2\t3\t\t\t\n3\t0.02\t1\t2\t3\t4\t5\t7\t\n"


def written(tmp_path, text):
    path = tmp_path / "some.trc"
    path.write_text(text)
    return path


def test_markers_rate_unit_and_gaps_are_read(tmp_path):
    raw = read_trc(written(tmp_path, HEADER + "\n" + ROWS))
    assert (raw.labels, raw.unit, raw.rate_hz) == (("LASI", "RASI"), "mm", 100.0)
    np.testing.assert_array_equal(raw.points[0], [[1, 2, 3], [4, 5, 6]])
    assert np.isnan(raw.points[1, 1]).all()
    np.testing.assert_allclose(raw.t, [0.0, 0.01, 0.02])


def test_a_doubled_tab_among_the_labels_moves_no_marker(tmp_path):
    raw = read_trc(written(tmp_path, HEADER.replace("LASI\t\t\t", "LASI\t\t\t\t") + ROWS))
    np.testing.assert_array_equal(raw.points[2], [[1, 2, 3], [4, 5, 7]])


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_decimal_commas_and_byte_order_marks_are_read(tmp_path, encoding):
    path = tmp_path / "some.trc"
    path.write_text(HEADER + ROWS.replace("0.01", "0,01").replace("\t7\t", "\t7,5\t"), encoding)
    raw = read_trc(path)
    assert raw.t[1] == 0.01 and raw.points[2, 1, 2] == 7.5


def test_points_without_a_name_behind_the_named_move_none(tmp_path):
    more = ROWS.replace("\t5\t6\n", "\t5\t6\t\t\t\t7\t8\t9\n")
    raw = read_trc(written(tmp_path, HEADER + more))
    assert (raw.labels, raw.unnamed) == (("LASI", "RASI"), 2)
    np.testing.assert_array_equal(raw.points[0], [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(raw.points[2], [[1, 2, 3], [4, 5, 7]])


def test_commas_part_what_a_spreadsheet_wrote(tmp_path):
    raw = read_trc(written(tmp_path, (HEADER + ",,,,,\n" + ROWS).replace("\t", ",")))
    assert (raw.labels, raw.unit, raw.rate_hz) == (("LASI", "RASI"), "mm", 100.0)
    np.testing.assert_array_equal(raw.points[2], [[1, 2, 3], [4, 5, 7]])


def test_an_empty_unit_shifts_no_other_field(tmp_path):
    assert read_trc(written(tmp_path, HEADER.replace("\tmm\t", "\t\t") + ROWS)).unit == ""


def test_a_last_line_that_was_cut_off_is_left_out(tmp_path):
    cut = (HEADER + ROWS)[: -len("\t4\t5\t7\t\n")]
    raw = read_trc(written(tmp_path, cut))
    assert (raw.stated_frames, len(raw.points)) == (3, 3)  # as many as it states: only the line's end is missing
    raw = read_trc(written(tmp_path, cut.replace("100\t3\t2", "100\t9\t2")))
    assert (raw.stated_frames, len(raw.points)) == (9, 2)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "does not begin with PathFileType"),
        (HEADER, "0 frames|0 frames of 2 markers|first line"),
        (HEADER.replace("100\t100\t3", "fast\t100\t3") + ROWS, "DataRate is 'fast', expected a number above 0"),
        (HEADER + ROWS.replace("\t6\n", "\tsix\n"), "row 1, field 8 is 'six', expected a number"),
        (HEADER + ROWS.replace("\t6\n", "\t6\t7\t8\n"), "row 1 has 10 fields, expected 8"),
    ],
)
def test_what_is_wrong_is_one_sentence(tmp_path, text, said):
    with pytest.raises(DataError, match=said):
        read_trc(written(tmp_path, text))
