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
