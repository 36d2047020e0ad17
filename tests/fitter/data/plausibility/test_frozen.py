"""An angle that stands still while its joint moves on."""

from dataclasses import replace

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
    assert (note.columns, note.row) == (("q1",), motion.first_row + 1)


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


def test_an_angle_that_leaps_out_of_its_first_readings_has_not_frozen():
    """Nobody saw it move before; it may have been switched on."""
    q = np.concatenate([np.zeros(10), 2.0 + 0.3 * np.arange(60)])
    q[40:] += 0.01  # what an encoder's count is
    assert not frozen_rows(q).any()


def test_a_reading_that_comes_twice_has_not_frozen():
    q = np.sin(2.0 * np.arange(0.0, 3.0, 2e-3))
    q[101::100] = q[100:-1:100]
    assert not frozen_rows(q).any()


def made_of(before, n_equal, after):
    """Return an angle that mostly takes steps of 1, in counts of 0.01: some steps, equal samples, other steps."""
    steps = [0.01, *[1.0] * 80, *before, *[0.0] * (n_equal - 1), *after]
    return np.concatenate([[0.0], np.cumsum(steps)]), 81 + len(before)


@pytest.mark.parametrize(
    ("before", "after", "frozen"),
    [
        ([0.3], [0.3, 0.3], True),  # it stops and goes on at once
        ([0.3], [0.1, 0.3], False),  # it stops slowly enough, and starts slowly
        ([0.1], [2.0, 0.3], True),  # it leaps
        ([0.1], [0.8, 0.3], False),  # that is no leap
        ([0.1], [0.15, 0.01], False),  # nor is it abrupt
        ([0.1], [2.0], False),  # nobody knows how it went on
        ([0.1], [-0.95, -0.3], False),  # it turned
        ([0.1], [-2.0, -0.3], True),  # faster than it ever went
        ([0.3], [], True),  # to the end
        ([0.1], [], False),
        ([0.6], [0.1, 0.3], True),  # no drive stops it so fast
    ],
)
def test_what_stops_or_starts_like_no_joint_has_frozen(before, after, frozen):
    q, first = made_of(before, 8, after)
    expected = np.zeros(len(q), dtype=bool)
    expected[first + 1 : first + 8] = frozen
    np.testing.assert_array_equal(frozen_rows(q), expected)


@pytest.mark.parametrize(("n_equal", "frozen"), [(5, False), (6, True)])
def test_a_few_equal_readings_are_none(n_equal, frozen):
    q, _ = made_of([1.0], n_equal, [1.0, 1.0])
    assert frozen_rows(q).any() == frozen


def test_counts_of_a_coarse_encoder_are_no_leaps():
    q, _ = made_of([0.3], 8, [0.3, 0.3])
    assert not frozen_rows(np.floor(q / 0.3)).any()


def test_of_a_joint_that_is_frozen_for_longest_nothing_is_left_out(arm, clean):
    motion = clean()
    n = len(motion.t)
    begin = n // 4 + int(np.argmax(np.abs(np.diff(motion.columns["q"][n // 4 : n // 3, 1]))))
    for end, left_out in ((begin + n // 4, True), (begin + 3 * n // 5, False)):
        found = look(standing(motion, 1, begin, end), arm)
        assert [note.kind for note in found.notes] == ["frozen"]
        assert (len(found.t) < n) == left_out


def test_without_angles_or_with_a_handful_nothing_is_looked_at(arm, clean):
    motion = clean()
    tip = replace(motion, columns={"tip": np.zeros((len(motion.t), 3))})
    assert look(tip, arm) is tip
    q = np.cumsum([0.0, 0.01, *[1.0] * 6, *[0.0] * 6, *[1.0] * 6])
    for n, looked in ((19, False), (20, True)):
        few = replace(motion, t=motion.t[:n], columns={"q": np.column_stack([q[:n], q[:n]])})
        assert bool(look(few, arm).notes) == looked
