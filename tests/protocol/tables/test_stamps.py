"""Stamps that leap, stand still, run backwards, or are in no seconds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import DataError
from protocol.tables.stamps import HOLE_STEPS, holes, leaps, require_rising, require_seconds, trial_rows

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
    assert leaps(T[:0]).tolist() == leaps(T[:1]).tolist() == []
    assert leaps(T[:2]).tolist() == leaps(np.array([0.0, 1.0, 1e6])).tolist() == []


def test_more_than_ten_missing_steps_are_a_hole():
    t = np.delete(T[:100], [*range(20, 30), *range(60, 69)])  # ten rows are missing, and nine
    assert holes(t).tolist() == [20]
    assert holes(T[:0]).tolist() == holes(T[:2]).tolist() == holes(T).tolist() == []


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


def test_trials_stand_in_one_piece():
    labels = np.array(["a", "a", "b"])
    assert trial_rows(labels, 3, "run.csv") == [("a", 0, 2), ("b", 2, 3)]
    assert trial_rows(None, 3, "run.csv") == [("", 0, 3)]
    with pytest.raises(DataError, match="trial 'a' goes on in row 14 after another one"):
        trial_rows(np.array(["a", "b", "b", "a"]), 4, "run.csv", first_row=10)


def test_the_longest_holes_are_the_leaps():
    steps = np.full(100, 1.0)
    steps[[20, 40, 60]] = [60.0, 50.0, 50.0]  # of 97 s measured the shorter two would be more, too
    assert leaps(np.concatenate([[0.0], np.cumsum(steps)])).tolist() == [21, 61]


@pytest.mark.parametrize(("step", "fits"), [(0.5, True), (1.0, True), (1.01, False)])
def test_a_row_a_second_is_slow_enough(step, fits):
    t = step * np.arange(10)
    if fits:
        require_seconds(t, "run.csv")
    else:
        with pytest.raises(
            DataError, match="run.csv: stamps lie 1.01 apart, expected seconds, and a row every 1 s"
        ):
            require_seconds(t, "run.csv")
    require_seconds(np.array([0.0]), "run.csv")
    require_seconds(np.empty(0), "run.csv")
    with pytest.raises(DataError, match="stamps lie 50 apart"):
        require_seconds(np.array([0.0, 50.0]), "run.csv")


def test_a_row_of_no_trial_is_named():
    with pytest.raises(DataError, match="there is no trial in row 2, expected a name or a number"):
        trial_rows(np.array(["a", "", "b"]), 3, "run.csv")
    with pytest.raises(DataError, match="there is no trial in row 11"):
        trial_rows(np.array(["", "a"]), 2, "run.csv", first_row=10)
    assert trial_rows(np.array(["a"]), 1, "run.csv") == [("a", 0, 1)]


def stamps_at(*steps: float) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(steps)])


@pytest.mark.parametrize(
    ("steps", "rows"),
    [
        ([1.0] * 4 + [10.0] + [1.0] * 4, []),  # ten steps are no hole
        ([1.0] * 4 + [10.5] + [1.0] * 4, [5]),  # a hole longer than the eight steps beside it
        ([1.0] * 6 + [11.0] + [1.0] * 5, []),  # as long as they are
        ([1.0] * 6 + [11.5] + [1.0] * 5, [7]),
        ([1.0] * 15 + [11.0] + [1.0] * 15 + [12.0], []),
        ([12.0] + [1.0] * 11, [1]),
        ([1.0, 100.0], []),
        ([1.0, 1.0, 100.0], [3]),
        ([1.0], []),
    ],
)
def test_a_leap_takes_longer_than_all_that_was_measured(steps: list[float], rows: list[int]) -> None:
    assert leaps(stamps_at(*steps)).tolist() == rows


@pytest.mark.parametrize(
    ("step", "said"),
    [
        (1.01, r"stamps lie 1.01 apart, .* a row every 1 s at least; are they in ms\? then --columns t=t:ms"),
        (500.0, r"are they in us\? then --columns t=t:us"),
        (100_000.0, r"are they in us or ns\? then --columns t=t:us"),
        (1e10, r"apart, .*; in which unit\?"),
    ],
)
def test_rows_further_apart_are_in_another_unit(step: float, said: str) -> None:
    with pytest.raises(DataError, match=said):
        require_seconds(np.array([0.0, step]), "x.csv")
