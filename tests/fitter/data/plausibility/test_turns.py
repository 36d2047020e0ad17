"""Angles that leap by a turn are unwrapped, and said."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.plausibility.turns import leaps_of, look
from tests.fitter.data.plausibility.conftest import changed


def wrapped(angle):
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


@pytest.mark.parametrize("seed", range(4))
def test_an_angle_that_wraps_is_what_it_was(arm, clean, seed):
    motion = clean(seed, 4.0)
    q = motion.columns["q"]
    found = look(changed(motion, q=wrapped(q)), arm)
    apart = found.columns["q"] - q
    np.testing.assert_allclose(apart - apart[0], 0.0, atol=1e-9)
    note = found.notes[0]
    assert note.kind == "turn" and "unwrapped" in note.text
    first = int(np.flatnonzero(np.abs(np.diff(wrapped(q)[:, int(note.columns[0][1]) - 1])) > 3.0)[0])
    assert note.row == first + 2 and note.from_s == motion.t[first + 1]


def test_derivatives_across_a_leap_are_dropped_and_the_target_follows(arm, clean):
    motion = clean(1, 4.0)
    q = wrapped(motion.columns["q"])
    dq = np.gradient(q, motion.t, axis=0)
    found = look(changed(motion, q=q, dq=dq, ref=wrapped(motion.columns["q"] + 0.1)), arm)
    assert "dq" not in found.columns
    np.testing.assert_allclose(found.columns["ref"] - found.columns["q"], 0.1, atol=1e-9)


def test_a_fast_wheel_does_not_leap():
    assert not leaps_of(np.arange(0.0, 300.0, 6.1)).any()


def test_a_joint_that_slides_has_no_turns(arm, clean):

    slides = replace(arm, joints=tuple(replace(joint, type="prismatic") for joint in arm.joints))
    motion = Measured("m", "m", 0, np.arange(9.0), {"q": np.tile([[0.0], [6.3], [0.0]], (3, 2))})
    assert look(motion, slides) is motion


TURN = 2.0 * np.pi


@pytest.mark.parametrize(
    ("steps", "leaps"),
    [
        ([0.1, 1.0, 0.1], [0, 1, 0]),
        ([0.1, -1.0, 0.1], [0, -1, 0]),
        ([0.1, 2.0, 0.1], [0, 2, 0]),
        ([0.1, 0.76, 0.1], [0, 1, 0]),  # a quarter of a turn in the same sample is what it may be off
        ([0.1, 0.74, 0.1], [0, 0, 0]),
        ([0.1, 1.24, 0.1], [0, 1, 0]),
        ([0.1, 1.26, 0.1], [0, 0, 0]),
        ([0.24, 1.0, 0.24], [0, 1, 0]),  # steps beside it that are a quarter as long
        ([0.26, 1.0, 0.26], [0, 0, 0]),
        ([0.9, 1.0, 0.1], [0, 1, 0]),  # one of the two is enough
        ([0.1, 1.0, 0.9], [0, 1, 0]),
        ([1.0, 0.1, 0.1], [1, 0, 0]),
        ([0.1, 0.1, -1.0], [0, 0, -1]),
        ([1.0, 0.1], [1, 0]),
        ([0.1, 1.0], [0, 1]),
        ([1.0, 1.0, 1.0, 1.0], [0, 0, 0, 0]),
        ([0.1, 1.0, 0.1, -1.0, 0.1], [0, 1, 0, -1, 0]),
    ],
)
def test_a_leap_is_a_whole_turn_beside_short_steps(steps, leaps):
    angle = np.concatenate([[0.3], 0.3 + TURN * np.cumsum(steps)])
    assert leaps_of(angle).tolist() == leaps


def leaping(n=40, at=(20,), n_joint=2, joint=1):
    """Return a motion in which one joint turns slowly, and leaps forward by a turn before some rows."""
    q = np.outer(0.01 * np.arange(n), np.ones(n_joint))
    for row in at:
        q[row:, joint] += TURN
    return Measured("m", "m.csv", 7, 3.0 + 0.01 * np.arange(n), {"q": q})


def test_turns_are_taken_out_of_the_joint_that_leapt_and_noted(arm):
    motion = leaping(at=(20, 30))
    found = look(motion, arm)
    np.testing.assert_allclose(found.columns["q"], np.outer(0.01 * np.arange(40), [1.0, 1.0]), atol=1e-12)
    (note,) = found.notes
    assert note.text == "q2 leaps by a turn 2 time(s): unwrapped"
    assert (note.row, note.from_s, note.columns) == (7 + 21, motion.t[20], ("q2",))
    assert motion.columns["q"][-1, 1] > 12.0  # what was given stays as it was


@pytest.mark.parametrize(("n", "unwrapped"), [(2, False), (3, True)])
def test_three_samples_show_a_leap(arm, n, unwrapped):
    motion = leaping(n, at=(n - 1,))
    assert (look(motion, arm) is not motion) == unwrapped


def test_without_angles_nothing_leaps(arm):
    motion = Measured("m", "m.csv", 0, np.arange(9.0), {"tip": np.zeros((9, 3))})
    assert look(motion, arm) is motion


def test_the_target_of_the_joint_that_leapt_is_put_beside_it(arm):
    motion = leaping()
    ref = np.full((40, 2), 0.2)
    ref[:, 1] += TURN * np.repeat([0.0, 1.0, -2.0, 0.0], 10)
    ref[:, 0] += TURN
    found = look(changed(motion, ref=ref), arm)
    np.testing.assert_allclose(found.columns["ref"], np.full((40, 2), 0.2) + [TURN, 0.0], atol=1e-12)


@pytest.mark.parametrize("role", ["dq", "ddq"])
@pytest.mark.parametrize(
    ("row", "spike", "usual", "derived_anew"),
    [
        (18, 90.0, 1.0, True),
        (19, 90.0, 1.0, True),
        (20, -90.0, 1.0, True),
        (21, 90.0, 1.0, True),
        (17, 90.0, 1.0, False),  # that is elsewhere
        (22, 90.0, 1.0, False),
        (20, 63.5, 1.0, True),  # a tenth of a turn in a hundredth of a second
        (20, 62.0, 1.0, False),
        (20, 90.0, -8.9, True),  # ten times as fast as usual
        (20, 90.0, -9.1, False),
    ],
)
def test_a_derivative_that_shows_the_leap_is_derived_anew(arm, role, row, spike, usual, derived_anew):
    rate = np.full((40, 2), usual)
    rate[row, 1] = spike
    other = "ddq" if role == "dq" else "dq"
    found = look(changed(leaping(), **{role: rate, other: np.ones((40, 2))}), arm)
    assert ({"dq", "ddq"} & set(found.columns) == set()) == derived_anew
    assert [note.columns for note in found.notes[1:]] == ([("dq", "ddq")] if derived_anew else [])


def test_a_derivative_is_looked_at_up_to_both_ends(arm):
    for at, row in ((1, 0), (39, 39)):
        rate = np.ones((40, 2))
        rate[row, 1] = 90.0
        assert "dq" not in look(changed(leaping(at=(at,)), dq=rate), arm).columns


def test_beside_a_joint_that_slides_others_leap(arm):
    slides = replace(arm, joints=(replace(arm.joints[0], type="prismatic"), arm.joints[1]))
    both = leaping()
    both.columns["q"][20:, 0] += TURN
    (note,) = look(both, slides).notes
    assert note.columns == ("q2",)
    assert [note.columns for note in look(both, arm).notes] == [("q1",), ("q2",)]
