"""An angle that stands still while its joint moves on."""

import numpy as np
import pytest

from fitter.data.plausibility.frozen import frozen_rows, look
from tests.fitter.data.plausibility.conftest import changed


def standing(motion, joint, begin, end):
    q = motion.columns["q"].copy()
    q[begin:end, joint] = q[begin, joint]
    return changed(motion, q=q)


@pytest.mark.parametrize("seed", range(4))
def test_rows_of_a_frozen_encoder_are_left_out(arm, clean, seed):
    motion = clean(seed)
    assert look(motion, arm) is motion
    begin = 300 + int(np.argmax(np.abs(np.diff(motion.columns["q"][300:600, 1]))))
    found = look(standing(motion, 1, begin, begin + 40), arm)
    (note,) = found.notes
    assert note.kind == "frozen" and note.columns == ("q2",) and "encoder" in note.text
    assert abs(note.row - (begin + 2)) <= 1
    assert len(motion.t) - len(found.t) == pytest.approx(39, abs=1)


def test_a_joint_that_never_moves_while_its_torque_works_is_asked_about(arm, clean):
    motion = clean()
    (note,) = look(standing(motion, 0, 0, len(motion.t)), arm).notes
    assert "q1 is" in note.text and "locked" in note.text


def test_a_joint_that_comes_to_rest_has_not_frozen():
    t = np.arange(0.0, 3.0, 2e-3)
    s = np.clip(t / 1.5, 0.0, 1.0)
    for q in (s**3 * (10 - 15 * s + 6 * s**2), np.round(s * (2.0 - s), 3)):
        assert not frozen_rows(q).any()


def test_a_freeze_that_began_in_a_slow_moment_is_seen_by_its_leap(arm, clean):
    motion = clean(2)
    q = motion.columns["q"][:, 1]
    begin = 100 + int(np.argmin(np.abs(np.diff(q[100:600]))))
    found = look(standing(motion, 1, begin, begin + 60), arm)
    assert found.notes and len(found.t) < len(motion.t)


def test_an_encoder_with_interpolated_counts_has_not_frozen_where_its_joint_turns():
    """At a turn it stays until the joint has come back by a count, and then steps back by it."""
    t = np.arange(0.0, 10.0, 1e-3)
    true, count = 0.4 * np.sin(2.0 * t), 3.4e-4
    q, way = true.copy(), 1.0
    for k in range(1, len(t)):
        off = true[k] - q[k - 1]
        if way * off < 0.0 and abs(off) < count:
            q[k] = q[k - 1]
        else:
            way = np.sign(off)
    assert np.count_nonzero(np.diff(q) == 0.0) > 20
    assert not frozen_rows(q).any()


def test_a_joint_that_stands_before_it_starts_has_not_frozen():
    t = np.arange(0.0, 3.0, 2e-3)
    assert not frozen_rows(np.sin(2.0 * np.maximum(t - 0.5, 0.0))).any()  # at once at full speed


def test_a_reading_that_comes_twice_has_not_frozen():
    q = np.sin(2.0 * np.arange(0.0, 3.0, 2e-3))
    q[101::100] = q[100:-1:100]
    assert not frozen_rows(q).any()
