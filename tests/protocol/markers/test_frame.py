"""Units and the axis that points up, of a person of ordinary size."""

import numpy as np
import pytest

from protocol.markers.frame import unit_of, up_of
from tests.protocol.markers.figure import walking


@pytest.mark.parametrize(("unit", "said", "found"), [(1.0, "mm", "m"), (1e3, "m", "mm"), (1e2, "m", "cm")])
def test_a_unit_that_contradicts_the_size_of_a_person_is_put_right(unit, said, found):
    notes, used = unit_of(unit * walking().points, said)
    assert [note.kind for note in notes] == ["unit"] and used == found


@pytest.mark.parametrize(("unit", "said"), [(1.0, "m"), (1e3, "mm"), (1e2, "cm")])
def test_a_unit_that_fits_is_not_mentioned(unit, said):
    assert unit_of(unit * walking().points, said) == ([], said)


def test_inches_are_mentioned_where_they_would_fit_a_whole_person_better():
    (note,), used = unit_of(walking().points / 0.0254, "mm")
    assert used == "cm" and "were they inches it would be 0.46 m" in note.text
    (note,), _ = unit_of(1e3 * walking().points, "m")
    assert "inches" not in note.text


@pytest.mark.parametrize(("said", "found"), [("", "m"), ("mm", "mm")])
def test_where_no_marker_was_seen_the_header_is_believed(said, found):
    assert unit_of(np.full((3, 5, 3), np.nan), said) == ([], found)


def test_a_person_stands_up():
    positions = walking().points
    assert up_of(positions, "+z") == ([], "+z")
    assert up_of(positions, "") == ([], "+z")
    notes, found = up_of(positions, "+y")
    assert [note.kind for note in notes] == ["up"] and found == "+z"
    assert up_of(-positions, "")[1] == "-z"
    assert up_of(positions[:, :, [0, 2, 1]], "")[1] == "+y"


def test_where_nothing_stands_up_the_header_is_believed():
    cube = np.random.default_rng(0).uniform(0.0, 1.0, (10, 30, 3))
    assert up_of(cube, "+y") == ([], "+y")
