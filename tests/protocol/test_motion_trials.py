"""Trials out of a motion file."""

from pathlib import Path

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.motion_trials import read_trials


def csv(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("second", ["0,30,3,2\n0.5,40,4,2\n", "7.25,30,3,2\n7.75,40,4,2\n"])
def test_every_trial_has_a_clock_of_its_own(tmp_path: Path, second: str) -> None:
    path = csv(tmp_path / "two.csv", "t,q2,q1,trial\n5,10,1,1\n5.5,20,2,1\n" + second)
    trials = read_trials(path, ["q"], ["dq"])
    assert list(trials) == [1, 2]
    for signals in trials.values():
        assert list(signals) == ["t", "q"]
        np.testing.assert_array_equal(signals["t"], [0.0, 0.5])
    np.testing.assert_array_equal(trials[2]["q"], [[3.0, 30.0], [4.0, 40.0]])


def test_without_a_trial_column_there_is_trial_1_and_strange_columns_do_no_harm(tmp_path: Path) -> None:
    path = csv(tmp_path / "one.csv", "t,q1,weather\n0,1,7\n1,2,\n")
    trials = read_trials(path, ["q"])
    assert list(trials) == [1]
    assert trials[1].keys() == {"t", "q"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,q1\n0,1\n1,2\n", r"no column t among its columns \(time, q1\)"),
        ("t,pos1\n0,1\n1,2\n", "no column q1"),
        ("t,q1\n0,here\n1,2\n", "q1 is not a finite number in row 1"),
        ("t,q1\n0,1\n1,\n", "q1 is not a finite number in row 2"),
        ("t,q1,q2\n0,1,2\n1,2,inf\n", "q2 is not a finite number in row 2"),
        ("t,q1\n0,1\n,2\n", "t is not a finite number in row 2"),
        ("t,q1,dq1,dq2\n0,1,1,1\n1,2,1,1\n", "different numbers of joints"),
        ("t,q1\n0,1\n2,2\n1,3\n", r"t goes from 2 to 1 s in row 3 \(trial 1\)"),
        ("t,q1,trial\n0,1,1\n1,2,1\n0,3,2\n0,4,2\n", r"t goes from 0 to 0 s in row 4 \(trial 2\)"),
        ("t,q1,trial\n0,1,1\n1,2,1\n0,3,2\n", "trial 2 has 1 sample"),
        ("t,q1,trial\n0,1,1\n1,2,1.5\n", "trial is 1.5 in row 2"),
        ("t,q1,trial\n0,1,1\n1,2,\n", "trial is nan in row 2"),
        ("t,q1,trial\n0,1,1\n1,2,inf\n", "trial is inf in row 2"),
        ("t,q1,trial\n0,1,first\n1,2,first\n", "trial is nan in row 1"),
        ("t,q1\n", "no rows"),
    ],
)
def test_what_cannot_be_used_is_said_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    path = csv(tmp_path / "bad.csv", text)
    with pytest.raises(DataError, match=said) as caught:
        read_trials(path, ["q"], ["dq"])
    assert str(path) in str(caught.value)
