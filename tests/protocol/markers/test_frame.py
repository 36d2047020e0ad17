"""Units and the axis that points up, of a person of ordinary size."""

import numpy as np
import pytest

from protocol.markers.frame import unit_of, up_of
from tests.protocol.markers.figure import walking

HAND_MM = np.array([[0, 0, 0], [60, 20, 0], [90, -10, 5], [80, 60, 0], [20, 70, 10]], dtype=float)[None]


@pytest.mark.parametrize(("unit", "said", "found"), [(1.0, "mm", "m"), (1e3, "m", "mm"), (1e2, "m", "cm")])
def test_a_unit_that_contradicts_the_size_of_a_person_is_put_right(unit, said, found):
    notes, used = unit_of(unit * walking().points, said)
    assert [note.kind for note in notes] == ["unit"] and used.name == found


@pytest.mark.parametrize(("unit", "said"), [(1.0, "m"), (1e3, "mm"), (1e2, "cm"), (10.0, "dm"), (1e6, "um")])
def test_a_unit_that_fits_is_not_mentioned(unit, said):
    notes, used = unit_of(unit * walking().points, said)
    assert not notes and used.name == said


@pytest.mark.parametrize("said", ["mm", "MM", "Mm", "millimeters", "Millimeters", "millimetre", " mm "])
def test_a_hand_is_as_large_as_the_header_says_in_short_or_in_full(said):
    notes, used = unit_of(HAND_MM, said)
    assert not notes and used.name == "mm" and used.factor == 1e-3


@pytest.mark.parametrize(("said", "metre"), [("inches", 0.0254), ("Inch", 0.0254), ("feet", 0.3048)])
def test_inches_and_feet_are_lengths(said, metre):
    notes, used = unit_of(walking().points / metre, said)
    assert not notes and used.factor == metre


def test_a_word_that_is_no_unit_of_length_is_said_with_what_fits():
    for said in ("furlongs", "ms"):
        (note,), used = unit_of(HAND_MM, said)
        assert used.name == "cm" and f"its header's unit '{said}' is not known" in note.text
        assert "mm (0.043 m) or in (1.1 m) would fit a person, too" in note.text
    assert unit_of(walking().points, "")[1].name == "m"


def test_a_size_that_no_unit_makes_a_persons_is_said():
    (note,), used = unit_of(1e7 * walking().points, "mm")
    assert used.name == "mm" and "no person's size in any unit: taken for mm" in note.text


def test_other_units_that_would_fit_are_mentioned():
    (note,), used = unit_of(walking().points / 0.0254, "mm")
    assert used.name == "cm" and "in (0.46 m) would fit a person, too" in note.text
    (note,), _ = unit_of(1e3 * walking().points, "m")
    assert "in (" not in note.text


@pytest.mark.parametrize(("said", "found"), [("", "m"), ("mm", "mm"), ("furlongs", "m")])
def test_where_no_marker_was_seen_the_header_is_believed(said, found):
    notes, used = unit_of(np.full((3, 5, 3), np.nan), said)
    assert not notes and used.name == found


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


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_who_spreads_the_arms_still_has_the_floor_underfoot(sign):
    standing = sign * (walking().points - [0.0, 0.0, 0.15])
    hand = np.nanmean(standing, axis=1, keepdims=True) * [1.0, 1.0, 1.5]
    positions = np.concatenate([standing, hand + [0.0, 0.75, 0.0], hand - [0.0, 0.75, 0.0]], axis=1)
    true, wrong = ("+z", "-z") if sign > 0.0 else ("-z", "+z")
    assert up_of(positions, true) == ([], true) and up_of(positions, "") == ([], "")
    (note,), found = up_of(positions, wrong)
    assert note.kind == "up" and found == true


@pytest.mark.parametrize("away", [0.4, 0.0])
def test_an_arm_that_moves_does_not_point_up(away):
    along = np.random.default_rng(0).uniform(0.0, 1.0, (100, 30, 3)) * [0.5, 0.2, 0.3]
    moved = along + [away, 0.3, 1.0] + 0.4 * np.linspace(0.0, 1.0, 100)[:, None, None] * [1.0, 0.0, 0.5]
    assert up_of(moved, "") == ([], "") and up_of(moved, "+z") == ([], "+z")
    assert up_of(-moved, "+z") == ([], "+z")


def test_arms_below_the_origin_do_not_contradict_the_header():
    arms = np.random.default_rng(0).uniform(-1.0, -0.3, (10, 30, 3))
    assert up_of(arms, "+z") == ([], "+z")
