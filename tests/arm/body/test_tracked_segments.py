"""Segments that a marker set follows."""

from arm.body.tracked_segments import TRACKED_SEGMENTS


def test_sided_segments_are_on_both_sides():
    assert len(set(TRACKED_SEGMENTS)) == 2 + 2 * 7
    assert {"pelvis", "thorax", "scapula_right", "foot_left"} <= set(TRACKED_SEGMENTS)
