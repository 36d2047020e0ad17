"""Rows that repeat the one before."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.plausibility.repeats import look, repeated_rows


@pytest.mark.parametrize("seed", range(3))
def test_a_logger_that_is_twice_as_fast_as_what_it_logs(arm, clean, seed):
    motion = clean(seed)
    assert look(motion, arm) is motion
    held = {role: np.repeat(values[::2], 2, axis=0) for role, values in motion.columns.items()}
    found = look(replace(motion, columns=held), arm)
    (note,) = found.notes
    assert note.kind == "repeated" and len(found.t) < 0.6 * len(motion.t)
    kept = np.isin(motion.t, found.t)
    assert kept[::2].all()


def test_rows_at_rest_repeat_rightly(arm, clean):
    motion = clean()
    q = np.vstack([np.zeros((200, 2)), np.cumsum(np.full((len(motion.t) - 200, 2), 1e-3), axis=0)])
    resting = replace(motion, columns={"q": q})
    assert look(resting, arm) is resting


#: Steps of an encoder of counts of 0.01 whose joint usually goes on by 1.
USUAL = [0.01, *[1.0] * 40]


def marked(steps):
    """Return which rows are repeated after the usual ones, counted from the row that the first step leads to."""
    q = np.concatenate([[0.0], np.cumsum([*USUAL, *steps])])[:, None]
    return (np.flatnonzero(repeated_rows(q, q)) - len(USUAL) - 1).tolist()


@pytest.mark.parametrize(
    ("steps", "expected"),
    [
        ([1.0, 0.0, 1.0], [1]),
        ([1.0, 0.0, 0.0, 0.0, 1.0], [1, 2, 3]),
        ([1.0, 0.0, 1.0, 0.0, 1.0], [1, 3]),
        ([0.11, 0.0, 0.11], [1]),
        ([0.09, 0.0, 1.0], []),  # it was slow before
        ([1.0, 0.0, 0.09], []),  # it is slow after
        ([-0.11, 0.0, -0.11], [1]),
        ([1.0, 0.0], []),  # nobody knows how it goes on
        ([0.05, 0.0, 1.0, 0.0, 1.0], [3]),
    ],
)
def test_a_row_is_repeated_where_the_joint_moves_on_both_sides(steps, expected):
    assert marked(steps) == expected


@pytest.mark.parametrize(("count", "expected"), [(0.33, [1]), (0.34, [])])
def test_a_step_of_three_counts_is_not_surely_a_motion(count, expected):
    coarse = np.concatenate([[0.0], np.cumsum([count, *[1.0] * 40, 1.0, 0.0, 1.0])])[:, None]
    assert (np.flatnonzero(repeated_rows(coarse, coarse)) - 42).tolist() == expected


def test_no_faster_than_three_counts_is_not_fast():
    for step, expected in ((0.75, []), (0.875, [42])):  # in numbers without rounding
        q = np.concatenate([[0.0], np.cumsum([0.25, *[1.0] * 39, step, 0.0, step])])[:, None]
        assert np.flatnonzero(repeated_rows(q, q)).tolist() == expected


def test_any_joint_that_moves_will_do():
    still = np.zeros(len(USUAL) + 4)
    q = np.column_stack([still, np.concatenate([[0.0], np.cumsum([*USUAL, 1.0, 0.0, 1.0])])])
    assert np.flatnonzero(repeated_rows(q, q)).tolist() == [len(USUAL) + 2]


def test_a_first_row_that_comes_twice_is_at_rest():
    q = np.concatenate([[0.0, 0.0], np.cumsum([1.0, 0.01, *[1.0] * 10])])[:, None]
    assert not repeated_rows(q, q).any()


def few(**more):
    """Return eight rows of which three repeat the third; the first is the eleventh of a file."""
    q = np.array([0.0, 0.01, 1.01, 1.01, 1.01, 1.01, 2.01, 3.01])
    columns = {"q": q[:, None], **{name: np.array(values, dtype=float)[:, None] for name, values in more.items()}}
    return Measured("few", "few.csv", 10, 5.0 + 0.1 * np.arange(8.0), columns)


def test_repeated_rows_are_left_out_of_every_column_and_noted(arm):
    labels = np.array(list("abcdefgh"))
    found = look(replace(few(ref=range(8)), labels=labels), arm)
    assert found.t.tolist() == [5.0 + 0.1 * k for k in (0, 1, 2, 6, 7)]
    assert found.columns["q"][:, 0].tolist() == [0.0, 0.01, 1.01, 2.01, 3.01]
    assert found.columns["ref"][:, 0].tolist() == [0.0, 1.0, 2.0, 6.0, 7.0]
    assert found.labels.tolist() == ["a", "b", "c", "g", "h"]
    (note,) = found.notes
    assert (note.kind, note.row, note.from_s) == ("repeated", 14, 5.0 + 0.1 * 3)
    assert note.text.startswith("3 of 8 rows repeat the row before")
    assert look(few(), arm).labels is None


@pytest.mark.parametrize("role", ["dq", "ddq", "tau"])
def test_a_row_repeats_all_that_was_measured_or_nothing(arm, role):
    for values, repeated in (([0, 0, 1, 1, 1, 1, 1, 1], True), ([0, 0, 1, 2, 3, 4, 5, 6], False)):
        motion = few(**{role: values})
        assert (look(motion, arm) is not motion) == repeated


def test_two_repeated_rows_or_seven_in_all_are_chance(arm):
    motion = few()
    seven = motion.rows(1, 8, "seven")
    assert look(seven, arm) is seven
    two = replace(motion, columns={"q": np.array([[0.0, 0.01, 0.51, 1.01, 1.01, 1.01, 2.01, 3.01]]).T})
    assert look(two, arm) is two
    no_angle = replace(motion, columns={"tip": np.zeros((8, 3))})
    assert look(no_angle, arm) is no_angle
