"""Stamps that leap, stand still, run backwards, or are in no seconds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import DataError
from protocol.tables.stamps import HOLE_STEPS, leaps, require_rising, require_seconds, trial_rows

T = 0.001 * np.arange(4000)


@pytest.mark.parametrize("by", [86400.0, 1.7e9, 10.0])
def test_a_leap_is_found(by):
    t = T.copy()
    t[2500:] += by
    assert leaps(t).tolist() == [2500]


def test_what_a_motion_bridges_is_no_leap():
    t = T.copy()
    t[1000:] += 0.5
    t[3000:] += 2.0
    assert leaps(t).tolist() == []
    assert leaps(T[:2]).tolist() == leaps(np.array([0.0, 1.0, 1e6])).tolist() == []


@given(
    st.lists(st.floats(1e-4, 1e-2), min_size=3, max_size=200),
    st.lists(st.tuples(st.integers(0, 10**6), st.floats(1e-3, 1e12)), max_size=20),
)
def test_a_grid_over_the_pieces_is_bounded_by_the_samples(steps, holes):
    steps = np.array(steps)
    for place, length in holes:
        steps[place % len(steps)] = length
    t = np.concatenate([[0.0], np.cumsum(steps)])
    if not (np.diff(t) > 0.0).all():
        return  # float64 swallowed a step beside a hole
    rows = leaps(t)
    lasts = sum(piece[-1] - piece[0] for piece in np.split(t, rows))
    assert lasts <= 2.0 * HOLE_STEPS * len(t) * np.median(np.diff(t)) * (1.0 + 1e-9) + 1e-9 * t[-1]


def test_time_must_rise():
    t = T.copy()
    require_rising(t, "run.csv")
    t[100] = t[50]
    with pytest.raises(DataError, match=r"run.csv: in row 111 time runs backwards from 0.099 s to 0.05 s"):
        require_rising(t, "run.csv", first_row=10)
    t[100] = t[99]
    with pytest.raises(DataError, match="in row 101 time stands still at 0.099 s"):
        require_rising(t, "run.csv")


def test_stamps_that_may_be_in_several_units_name_both():
    require_seconds(T, "run.csv")
    require_seconds(np.arange(10.0), "run.csv")
    with pytest.raises(DataError, match="are they in ms or us"):
        require_seconds(100.0 * np.arange(10), "run.csv")
    with pytest.raises(DataError, match="in which unit"):
        require_seconds(1e14 * np.arange(10), "run.csv")


def test_trials_stand_in_one_piece():
    labels = np.array(["a", "a", "b"])
    assert trial_rows(labels, 3, "run.csv") == [("a", 0, 2), ("b", 2, 3)]
    assert trial_rows(None, 3, "run.csv") == [("", 0, 3)]
    with pytest.raises(DataError, match="trial 'a' goes on in row 14 after another one"):
        trial_rows(np.array(["a", "b", "b", "a"]), 4, "run.csv", first_row=10)
