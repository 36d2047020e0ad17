"""An angle that stands still while its joint moves on."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.motions import Measured
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


def jerky(n_equal=8):
    """Return angles of two joints that both freeze for a number of samples, once at row 81 and once at row 60."""
    first, _ = made_of([], n_equal, [1.0] * 10)
    second = np.concatenate([[0.0, 0.01], 0.01 + np.cumsum([*[1.0] * 59, *[0.0] * (n_equal - 1)])])
    rest = second[-1] + np.arange(1.0, len(first) - len(second) + 1)
    return np.column_stack([first, np.concatenate([second, rest])])


def test_frozen_rows_are_left_out_of_every_column_and_each_joint_noted(arm):
    q = jerky()
    n = len(q)
    t, labels = 3.0 + 0.01 * np.arange(n), np.array([str(k) for k in range(n)])
    motion = Measured("m", "m.csv", 20, t, {"q": q, "ref": np.arange(2.0 * n).reshape(n, 2)}, labels=labels)
    found = look(motion, arm)
    gone = sorted(set(range(n)) - {int(label) for label in found.labels})
    assert gone == [*range(61, 68), *range(82, 89)]
    np.testing.assert_array_equal(found.t, np.delete(t, gone))
    for role in ("q", "ref"):
        np.testing.assert_array_equal(found.columns[role], np.delete(motion.columns[role], gone, axis=0))
    assert [(note.columns, note.row, note.from_s) for note in found.notes] == [
        (("q1",), 103, t[82]),
        (("q2",), 82, t[61]),
    ]
    assert found.notes[0].text.startswith(f"q1 stands still in 7 of {n} samples and leaps on")


def test_beside_a_joint_that_never_moves_others_are_looked_at(arm):
    q = jerky() * [0.0, 1.0] + [0.25, 0.0]
    n = len(q)
    tau = np.column_stack([np.linspace(-2.0, 3.0, n), np.ones(n)])
    motion = Measured("m", "m.csv", 20, 3.0 + 0.01 * np.arange(n), {"q": q, "tau": tau})
    found = look(motion, arm)
    assert [(note.columns, note.row, note.from_s) for note in found.notes] == [
        (("q1",), 21, 3.0),
        (("q2",), 82, motion.t[61]),
    ]
    assert found.notes[0].text.startswith(f"q1 is 0.25 in all {n} samples while tau1 works between -2 and 3:")
    assert len(found.t) == n - 7
    for silent in ({"tau": np.ones((n, 2))}, {}):  # it was not asked to move
        quiet = look(replace(motion, columns={"q": q, **silent}), arm)
        assert [note.columns for note in quiet.notes] == [("q2",)]
    still = replace(motion, columns={"q": np.ones((n, 2)), "tau": tau})
    assert look(still, arm) is still  # nor does anything move


def test_a_turn_goes_back_by_no_more_than_a_usual_step():
    """Products of small steps tell the way as well as those of large ones."""
    for last, frozen in ((-0.999, False), (-1.001, True), (1.0, True)):
        q, first = made_of([0.1], 8, [last, 0.3 * np.sign(last)])
        assert frozen_rows(q)[first + 1] == frozen
