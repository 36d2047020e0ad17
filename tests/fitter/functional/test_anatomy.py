"""Names of segments and landmarks."""

from arm.body.tracked_segments import TRACKED_SEGMENTS
from fitter.functional.anatomy import LANDMARKS


def test_every_landmark_is_on_a_segment_of_its_own_side():
    for landmark, segment in LANDMARKS.items():
        assert segment in TRACKED_SEGMENTS
        if segment.endswith(("_left", "_right")):
            assert landmark.rpartition("_")[2] == segment.rpartition("_")[2]


def test_there_are_as_many_as_the_design_lists():
    assert len(TRACKED_SEGMENTS) == 2 + 2 * 7
    assert len(LANDMARKS) == 5 + 2 * 18
