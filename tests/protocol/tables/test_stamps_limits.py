"""Where a hole begins to be a leap, and which row a sentence names."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.stamps import leaps, require_rising, require_seconds, trial_rows


def stamps(*steps: float) -> np.ndarray:
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
    assert leaps(stamps(*steps)).tolist() == rows


def test_of_several_holes_the_longest_are_leaps() -> None:
    """Thirty steps are measured: holes of 12 and 13 s may stay, one of 14 s beside them may not."""
    steps = [1.0] * 10 + [14.0] + [1.0] * 10 + [12.0] + [1.0] * 10 + [13.0]
    assert leaps(stamps(*steps)).tolist() == [11]
    assert leaps(stamps(*steps[:32])).tolist() == []


@pytest.mark.parametrize(
    ("t", "said"),
    [
        ([0.0, 1.0, 1.0], "in row 3 time stands still at 1 s"),
        ([0.0, 0.0, 1.0], "in row 2 time stands still at 0 s"),
        ([0.0, 2.0, 1.0, 0.5], "in row 3 time runs backwards from 2 s to 1 s"),
    ],
)
def test_the_first_row_that_does_not_rise_is_named(t: list[float], said: str) -> None:
    with pytest.raises(DataError, match=said):
        require_rising(np.array(t), "x.csv")
    with pytest.raises(DataError, match="in row 103" if "row 3" in said else "in row 102"):
        require_rising(np.array(t), "x.csv", first_row=100)


@pytest.mark.parametrize("t", [[], [0.0], [0.0, 1.0], [0.0, 1e-9], [0.0, 1.0, 9.0, 10.0]])
def test_a_row_a_second_is_in_seconds(t: list[float]) -> None:
    require_seconds(np.array(t), "x.csv")
    require_rising(np.array(t), "x.csv")


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


def test_a_row_without_a_trial_is_named() -> None:
    assert trial_rows(np.array(["a"]), 1, "x") == [("a", 0, 1)]
    assert trial_rows(np.array(["a", "b", "c"]), 3, "x") == [("a", 0, 1), ("b", 1, 2), ("c", 2, 3)]
    with pytest.raises(DataError, match="there is no trial in row 3, expected a name or a number"):
        trial_rows(np.array(["a", "a", "", "b"]), 4, "x")
    with pytest.raises(DataError, match="trial 'a' goes on in row 3 after another one"):
        trial_rows(np.array(["a", "b", "a"]), 3, "x")
