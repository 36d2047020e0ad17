"""Rows in blocks to motions in stretches."""

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
