"""Rows in blocks to motions in stretches."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.data.motions import Measured
from fitter.data.resample import resample
from fitter.data.stretches import joined, stretches
from limbcal.errors import DataError

STEP = 1e-3


def measured(t, labels=None):
    """Return rows whose column says which they are."""
    row = np.arange(float(len(t)))[:, None]
    return Measured("run", "run.csv", 0, np.asarray(t), {"q": row}, labels=labels)


def cut(rows, ends):
    bounds = sorted({0, *(end for end in ends if end < len(rows.t)), len(rows.t)})
    return [rows.rows(a, b, rows.name) for a, b in zip(bounds[:-1], bounds[1:], strict=True)]


def counted(stretch):
    return stretch.motion.columns["q"][stretch.counted, 0].astype(int).tolist()


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.integers(20, 400), min_size=1, max_size=4),
    st.lists(st.integers(1, 1500), max_size=12),
    st.integers(30, 120),
    st.integers(0, 40),
)
def test_every_row_counts_once_however_the_rows_come(lengths, ends, longest, margin):
    n = sum(lengths)
    labels = np.repeat([str(k) for k in range(len(lengths))], lengths)
    rows = measured(STEP * np.arange(n), labels)
    found = list(stretches(cut(rows, ends), longest, lambda _: margin))
    assert sum((counted(s) for s in found), []) == list(range(n))
    assert [s.motion.name for s in found if s.begins] == [f"run/{k}" for k in range(len(lengths))]
    assert sum(s.ends for s in found) == len(lengths)
    for s in found:
        assert s.whole or s.step_s == STEP
        before, after = s.counted.start, len(s.motion.t) - s.counted.stop
        assert s.begins == (before == 0) or margin == 0
        assert s.begins or before >= margin
        assert s.ends or after >= margin


def test_short_motions_come_as_they_were_measured():
    rows = measured(5.0 + STEP * np.arange(50))
    (only,) = stretches(cut(rows, [10, 20]), 50, lambda _: 5)
    assert only.whole
    assert np.array_equal(only.motion.t, rows.t)


def test_a_short_motion_keeps_its_holes():
    t = STEP * np.arange(50)
    t[30:] += 0.5
    (only,) = stretches(cut(measured(t), [10, 40]), 50, lambda _: 5)
    assert only.whole and np.array_equal(only.motion.t, t) and only.motion.notes == ()


def test_a_long_motion_is_parted_at_a_hole():
    t = STEP * np.arange(1000)
    t[700:] += 0.5
    found = list(stretches(cut(measured(t), range(0, 1000, 90)), 300, lambda _: 20))
    assert sum((counted(s) for s in found), []) == list(range(1000))
    ends = [counted(s)[-1] for s in found if s.ends]
    assert ends == [699, 999]
    assert found[-1].motion.name == "run#2"
    ((parted,),) = [s.motion.notes for s in found if s.motion.notes]
    assert parted.text == "in row 701 t leaps from 0.699 to 1.2 s: parted there"
    assert (parted.row, parted.from_s, parted.to_s) == (701, pytest.approx(0.699), pytest.approx(1.2))


def test_irregular_stamps_are_resampled_as_in_the_whole():
    rng = np.random.default_rng(0)
    t = STEP * (np.arange(3000) + rng.uniform(-0.3, 0.3, 3000))
    rows = Measured("run", "run.csv", 0, t, {"q": np.sin(9.0 * t)[:, None], "ref": np.round(t, 1)[:, None]})
    whole = resample(rows)
    found = list(stretches(cut(rows, range(0, 3000, 70)), 800, lambda _: 10, 1.0 / whole.dt_s))
    assert len(found) > 2
    for name, values in whole.measured.columns.items():
        parts = np.concatenate([s.motion.columns[name][s.counted] for s in found])
        assert np.allclose(parts, values, atol=1e-12)


@pytest.mark.parametrize("rate_hz", [1700.0, 400.0])
def test_a_given_rate_is_reached_as_in_the_whole(rate_hz):
    t = STEP * np.arange(4000)
    rows = Measured("run", "run.csv", 0, t, {"q": np.random.default_rng(1).normal(size=(4000, 1)).cumsum(axis=0)})
    whole = resample(rows, rate_hz)
    found = list(stretches(cut(rows, range(0, 4000, 333)), 900, lambda _: 10, rate_hz))
    parts = np.concatenate([s.motion.columns["q"][s.counted] for s in found])
    both = min(len(parts), len(whole.measured.t))
    assert abs(len(parts) - len(whole.measured.t)) <= 1
    assert np.allclose(parts[: both - 1], whole.measured.columns["q"][: both - 1], atol=1e-9)


def test_a_clock_that_changes_its_rate_is_said():
    t = np.concatenate([STEP * np.arange(1000), 1.0 + 3 * STEP * np.arange(1000)])
    with pytest.raises(DataError, match="had a sample every 0.001 s, but in rows"):
        list(stretches(cut(measured(t), [500, 1500]), 300, lambda _: 20))


def test_a_trial_in_two_pieces_and_time_that_runs_backwards_are_said():
    labels = np.repeat(["a", "b", "a"], 30)
    with pytest.raises(DataError, match="trial 'a' goes on in row 61"):
        list(stretches([measured(STEP * np.arange(90), labels)], 100, lambda _: 5))
    t = STEP * np.arange(90)
    t[40] = t[39]
    with pytest.raises(DataError, match="in row 41 time stands still"):
        list(stretches(cut(measured(t), [35]), 100, lambda _: 5))


def test_joined_rows_are_the_rows():
    rows = measured(STEP * np.arange(40), np.repeat(["x"], 40))
    again = joined(cut(rows, [7, 9, 30]))
    assert np.array_equal(again.t, rows.t)
    assert np.array_equal(again.columns["q"], rows.columns["q"])
    assert again.labels.tolist() == rows.labels.tolist()


@pytest.mark.parametrize(
    ("n", "counts"),
    [
        (30, [30]),
        (31, [31]),
        (207, [207]),
        (208, [138, 70]),
        (345, [138, 207]),
        (346, [138, 138, 70]),
        (483, [138, 138, 207]),
        (484, [138, 138, 138, 70]),
    ],
)
@pytest.mark.parametrize("block", [1000, 100, 7])
def test_a_stretch_counts_two_margins_and_leaves_no_less_than_one(n, counts, block):
    """A margin of five samples is one of 69 rows, with what it takes to lay a grid."""
    found = list(stretches(cut(measured(STEP * np.arange(n)), range(0, n, block)), 30, lambda _: 5))
    assert [s.counted.stop - s.counted.start for s in found] == counts
    assert [s.counted.start for s in found] == [0, *[69] * (len(counts) - 1)]
    lengths = [a + b for a, b in zip([0, *[69] * (len(counts) - 1)], counts, strict=True)]
    assert [len(s.motion.t) for s in found] == [a + 69 for a in lengths[:-1]] + [lengths[-1]]
    assert [(s.begins, s.ends) for s in found] == [(k == 0, k == len(counts) - 1) for k in range(len(counts))]
    assert [s.step_s for s in found] == ([0.0] if n == 30 else [STEP] * len(counts))
    assert [s.whole for s in found] == [len(counts) == 1] * len(counts)


def test_a_long_stretch_counts_what_was_asked_for():
    found = list(stretches([measured(STEP * np.arange(900))], 200, lambda _: 5))
    assert [s.counted.stop - s.counted.start for s in found] == [200, 200, 200, 200, 100]


@pytest.mark.parametrize(("steps", "parted"), [(9.9, False), (10.1, True)])
def test_a_long_motion_is_parted_where_more_than_ten_steps_are_missing(steps, parted):
    t = STEP * np.arange(600)
    t[300:] += (steps - 1.0) * STEP
    ends = [s.motion.name for s in stretches([measured(t)], 100, lambda _: 5) if s.ends]
    assert ends == (["run#1", "run#2"] if parted else ["run"])


@pytest.mark.parametrize(
    ("n", "names"),
    [(15, ["run#1", "run#2"]), (16, ["run#1", "run#2", "run#3"]), (101, ["run#1", "run#2", "run#3"])],
)
def test_between_holes_sixteen_samples_are_a_piece(n, names):
    t = np.concatenate([STEP * np.arange(300), 1.0 + STEP * np.arange(n), 2.0 + STEP * np.arange(300)])
    found = list(stretches(cut(measured(t), range(0, len(t), 50)), 100, lambda _: 5))
    assert [s.motion.name for s in found if s.ends] == names
    rows = sum((counted(s) for s in found), [])
    assert rows == [k for k in range(len(t)) if n > 15 or not 300 <= k < 315]
    said = [note.row for s in found for note in s.motion.notes]
    assert said == [301, *([301 + n] if n > 15 else [])]


def test_motions_are_told_by_their_names_too():
    one, other = measured(STEP * np.arange(40)), measured(STEP * np.arange(30))
    found = list(stretches([one, replace(other, name="b")], 100, lambda _: 5))
    assert [(s.motion.name, len(s.motion.t)) for s in found] == [("run", 40), ("b", 30)]
    with pytest.raises(DataError, match="trial '' goes on in row 1 after another one"):
        list(stretches([one, replace(other, name="b"), one], 100, lambda _: 5))
