"""A torque that stands at its limit does not count, and is said."""

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.plausibility.saturated import CONTRADICTED, cut_off, look
from fitter.data.trials import to_trials
from tests.fitter.data.plausibility.conftest import changed


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_every_sample_at_the_limit_is_marked(arm, clean, seed, share):
    motion = clean(seed)
    assert look(motion, arm) is motion
    tau = motion.columns["tau"]
    limit = share * np.abs(tau).max(axis=0)
    found = look(changed(motion, tau=np.clip(tau, -limit, limit)), arm)
    marked = found.columns[CONTRADICTED] > 0.0
    at_limit = np.abs(tau) >= limit
    assert np.mean(marked[at_limit]) > 0.7 and not marked[~at_limit].any()
    assert all("cut off?" in note.text and note.kind == "saturated" for note in found.notes)
    assert {note.columns for note in found.notes} <= {("tau1",), ("tau2",)}
    for note in found.notes:
        k = int(np.flatnonzero(marked[:, int(note.columns[0][3:]) - 1])[0])
        assert (note.row, note.from_s) == (motion.first_row + k + 1, motion.t[k])
    (trial,) = to_trials([found])
    assert trial.contradicted is not None and trial.counted.mean() < 1.0


def test_a_peak_that_is_rounded_is_no_limit():
    t = np.arange(0.0, 4.0, 2e-3)
    assert not cut_off(np.round(10.0 * np.sin(2.0 * t), 2)).any()


def test_a_torque_of_steps_is_what_it_is():
    assert not cut_off(np.repeat([0.0, 4.0, -4.0, 2.0, 4.0, -2.0, 0.0], 50)).any()
    assert not cut_off(np.repeat([4.0, -4.0, 4.0, -4.0], 50)).any()


def slope(first, last):
    """Return a torque that goes by its resolution of 0.01 from one level to another, without these."""
    n = round(abs(last - first) / 0.01)
    return np.linspace(first, last, n + 1)[1:-1].tolist()


def at(level, n=8):
    return [level] * n


@pytest.mark.parametrize(
    ("parts", "marked"),
    [
        ([slope(-1, 0.5), at(1.0), slope(1.0, 0)], [1]),  # in by a leap, out by steps
        ([slope(-1, 1.0), at(1.0), slope(0.5, 0)], [1]),  # and the other way round
        ([slope(-1, 1.0), at(1.0), slope(1.0, 0)], []),  # a peak that is rounded
        ([at(1.0), slope(0.5, -1)], [0]),
        ([at(1.0), slope(1.0, -1)], []),
        ([slope(-1, 0.5), at(1.0)], [1]),
        ([slope(-1, 1.0), at(1.0)], []),
        ([slope(-1, 0.5), at(1.0, 4), slope(0.5, 0)], []),
        ([slope(-1, 0.5), at(1.0, 5), slope(0.5, 0)], [1]),
        ([slope(-0.2, -0.5), at(-1.0), slope(-0.5, 0.5), at(1.0), slope(0.5, 0)], [1, 3]),
        ([slope(-1, -0.5), at(0.3, 9), slope(-0.4, 0.5), at(1.0), slope(0.5, 0)], []),  # it stands elsewhere, too
        ([slope(-1, -0.5), at(0.3, 7), slope(-0.4, 0.5), at(1.0), slope(0.5, 0)], [3]),
        ([at(0.0, 20), slope(0.5, 0.8), at(1.0), slope(0.8, 0.2)], [2]),  # at rest it is no limit
        ([slope(-1, -0.5), at(1.0, 1000), slope(0.5, 0)], []),  # that is what it is made of
        ([at(1.0, 40)], []),
    ],
)
def test_a_limit_is_entered_or_left_by_more_than_steps(parts, marked):
    expected = [[k in marked] * len(part) for k, part in enumerate(parts)]
    assert cut_off(np.concatenate(parts)).tolist() == sum(expected, [])


def test_a_torque_that_is_missing_or_a_handful_is_left_alone(arm, clean):
    motion = clean()
    for n, looked in ((9, False), (10, True)):
        tau = np.column_stack([[*at(1.0, 5), *[0.1 * k for k in range(5)]][:n]] * 2)
        few = changed(motion.rows(0, n, "few"), tau=tau)
        assert bool(look(few, arm).notes) == looked
    blank = motion.rows(0, 20, "blank")
    del blank.columns["tau"]
    assert look(blank, arm) is blank


@pytest.mark.parametrize(
    ("lower", "words"), [(-1.0, "±1 in 16"), (-1.0005, "±1 in 16"), (-0.99, "-0.99 and 1 in 16")]
)
def test_limits_on_both_sides_are_said_as_one_where_they_are_alike(arm, lower, words):
    tau = np.concatenate([slope(0.2, -0.5), at(lower), slope(-0.5, 0.5), at(1.0), slope(0.5, 0)])
    n = len(tau)
    motion = Measured("m", "m.csv", 30, 2.0 + 0.1 * np.arange(n), {"tau": np.column_stack([np.zeros(n), tau])})
    found = look(motion, arm)
    (note,) = found.notes
    assert note.text == f"tau2 stands at {words} of {n} samples: cut off? They do not count"
    first = len(slope(0.2, -0.5))
    assert (note.row, note.from_s, note.columns) == (30 + first + 1, motion.t[first], ("tau2",))
    assert found.columns[CONTRADICTED][:, 0].sum() == 0.0 and found.columns[CONTRADICTED][:, 1].sum() == 16.0


@pytest.mark.parametrize(("step", "marked"), [(2.75, False), (3.0, False), (3.25, True)])
def test_three_steps_of_the_resolution_enter_a_peak(step, marked):
    """In numbers that rounding does not change."""
    tau = np.concatenate([np.arange(-40.0, 0.0), np.full(8, step - 1.0), np.arange(-1.0, -40.0, -1.0)])
    tau = np.concatenate([[-40.0], tau])
    assert cut_off(tau).any() == marked


def test_a_tenth_of_the_samples_must_remain():
    tau = np.concatenate([[0.0, 0.01, 0.0, 0.01], [1.0] * 36])
    assert cut_off(tau).any()
    assert not cut_off(np.append(tau, 1.0)).any()
