"""Trials out of a motion file."""

import json
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm
from limbcal.errors import DataError
from playback.motion_trials import read_trials

ARM = load_arm("dd-arm")


def csv(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("second", ["0,30,3,2\n0.5,40,4,2\n", "7.25,30,3,2\n7.75,40,4,2\n"])
def test_every_trial_has_a_clock_of_its_own(tmp_path: Path, second: str) -> None:
    path = csv(tmp_path / "two.csv", "t,q2,q1,trial\n5,10,1,1\n5.5,20,2,1\n" + second)
    trials = read_trials(path, ARM, ["q"], ["dq"]).signals
    assert list(trials) == [1, 2]
    for signals in trials.values():
        assert list(signals) == ["t", "q"]
        np.testing.assert_array_equal(signals["t"], [0.0, 0.5])
    np.testing.assert_array_equal(trials[2]["q"], [[3.0, 30.0], [4.0, 40.0]])


def test_without_a_trial_column_there_is_trial_1_and_strange_columns_do_no_harm(tmp_path: Path) -> None:
    path = csv(tmp_path / "one.csv", f"t,q1,q2,weather,id,tau1\n0,1,1,7,{2**60 + 1},\n1,2,2,,x,\n")
    trials = read_trials(path, ARM, ["q"]).signals
    assert list(trials) == [1]
    assert trials[1].keys() == {"t", "q"}


def test_trials_with_names_are_counted_and_that_is_said(tmp_path: Path) -> None:
    path = csv(tmp_path / "named.csv", "t,q1,q2,trial\n0,1,1,slow\n1,2,2,slow\n0,3,3,fast\n1,4,4,fast\n")
    found = read_trials(path, ARM, ["q"])
    assert list(found.signals) == [1, 2]
    (note,) = found.notes
    assert note.text == "trials are counted: 1 is 'slow' from row 1, 2 is 'fast' from row 3"


def test_a_leap_of_a_day_makes_two_trials(tmp_path: Path) -> None:
    t = 0.01 * np.arange(100)
    t[60:] += 86400.0
    path = tmp_path / "leap.npz"
    np.savez(path, t=t, q1=t, q2=t)
    found = read_trials(path, ARM, ["q"])
    assert [len(signals["t"]) for signals in found.signals.values()] == [60, 40]
    (note,) = found.notes
    assert note.kind == "gap" and note.row == 61 and note.to_s == pytest.approx(86400.6)


def test_rows_that_are_missing_are_said(tmp_path: Path) -> None:
    t = 5.0 + 0.01 * np.arange(100)
    t = np.delete(t, [*range(20, 35), *range(60, 80)])
    path = tmp_path / "holes.npz"
    np.savez(path, t=t, q1=t, q2=t)
    (note,) = read_trials(path, ARM, ["q"]).notes
    assert note.kind == "gap" and note.row == 21 and note.from_s == pytest.approx(5.19)
    assert note.text.startswith("in row 21 t goes from 5.19 to 5.35 s, and so 1 more time(s): rows are missing")


@pytest.mark.parametrize("role", ["q", "ref"])
@pytest.mark.parametrize(("name", "mapping", "asked"), [("", None, 1), ("_deg", None, 0), ("", ":rad", 0)])
def test_angles_that_seem_to_be_degrees_are_asked_about(
    tmp_path: Path, role: str, name: str, mapping: str | None, asked: int
) -> None:
    t, path = 0.01 * np.arange(200), tmp_path / "swing.npz"
    np.savez(path, t=t, **{f"{role}{j}{name}": 60.0 * np.sin(3.0 * t + j) for j in (1, 2)})
    columns = mapping and f"{role}={role}{{j}}{mapping}"
    notes = [note for note in read_trials(path, ARM, [role], columns=columns).notes if "degrees?" in note.text]
    assert [note.columns for note in notes] == asked * [(f"{role}1", f"{role}2")]
    if asked:
        assert f"{role}1 goes 120 rad to and fro at up to 179 rad/s: degrees? Then --columns" in notes[0].text


@pytest.mark.parametrize(("scale", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_stamps_that_cannot_be_seconds_are_asked_about(tmp_path: Path, scale: float, unit: str) -> None:
    t = 0.01 * np.arange(100)
    path = tmp_path / "stamps.npz"
    np.savez(path, t=scale * t, q1=t, q2=t)
    with pytest.raises(DataError, match=rf"stamps lie .* apart, expected seconds.* --columns t=t:{unit}"):
        read_trials(path, ARM, ["q"])
    (signals,) = read_trials(path, ARM, ["q"], columns=f"t=t:{unit}").signals.values()
    np.testing.assert_allclose(signals["t"], t)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("clock,q1,q2\n0,1,1\n1,2,2\n", r"no column 't' among its columns clock, q1, q2"),
        ("t,pos1,q2\n0,1,1\n1,2,1\n", "no column 'q1'"),
        ("t,q1,q2\n0,here,1\n1,2,1\n", "row 1: column 'q1' holds 'here', expected a number"),
        ("t,q1,q2\n0,1,1\n1,,1\n", "column 'q1', row 2: found nothing"),
        ("t,q1,q2\n0,1,2\n1,2,inf\n", "column 'q2', row 2: found inf"),
        ("t,q1,q2\n0,1,1\n,2,1\n", "column 't', row 2: found nothing"),
        ("t,q1,q2,dq1\n0,1,1,1\n1,2,1,1\n", "no column 'dq2' beside dq1"),
        ("t,q1,q2,q3\n0,1,1,1\n1,2,1,1\n", "a column 'q3', but the arm has 2 joints"),
        ("t,q1,q2\n0,1,1\n2,2,1\n1,3,1\n", r"in row 3 time runs backwards from 2 s to 1 s"),
        ("t,q1,q2,trial\n0,1,1,1\n1,2,1,1\n0,3,1,2\n0,4,1,2\n", r"in row 4 time stands still at 0 s"),
        ("t,q1,q2,trial\n0,1,1,1\n1,2,1,1\n0,3,1,2\n", "trial 2 has 1 sample"),
        ("t,q1,q2,trial\n0,1,1,1\n1,2,1,1\n2,2,1,\n3,2,1,\n", "there is no trial in row 3"),
        ("t,q1,q2\n", "there is a header but no row"),
    ],
)
def test_what_cannot_be_used_is_said_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    path = csv(tmp_path / "bad.csv", text)
    with pytest.raises(DataError, match=said) as caught:
        read_trials(path, ARM, ["q"], ["dq"])
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("labels", "trials"),
    [
        (("3", "7"), [3, 7]),
        (("3.0", "7.0"), [3, 7]),
        (("-1", "0"), [-1, 0]),
        (("1.5", "2"), [1, 2]),
        (("1", "1.0"), [1, 2]),  # names that are one number
        (("inf", "nan"), [1, 2]),
        (("b", "a"), [1, 2]),
    ],
)
def test_trials_have_their_own_numbers_if_they_are_numbers(
    tmp_path: Path, labels: tuple[str, str], trials: list[int]
) -> None:
    rows = "".join(f"{k},{k},{k},{label}\n" for label in labels for k in range(2))
    assert list(read_trials(csv(tmp_path / "a.csv", "t,q1,q2,trial\n" + rows), ARM, ["q"]).signals) == trials


def test_trials_that_are_cells_of_a_file_are_counted(tmp_path: Path) -> None:
    cells = [{"t": [0.0, 1.0], "q1": [k, k], "q2": [k, 2 * k]} for k in (5, 6, 7)]
    path = tmp_path / "cells.json"
    path.write_text(json.dumps({"runs": cells}), encoding="utf-8")
    found = read_trials(path, ARM, ["q"], columns="t=runs.t,q=runs.q{j}").signals
    assert {number: signals["q"][0, 0] for number, signals in found.items()} == {1: 5.0, 2: 6.0, 3: 7.0}


def test_a_single_row_between_two_leaps_is_no_trial(tmp_path: Path) -> None:
    t = np.concatenate([0.01 * np.arange(50), [5e5], 1e6 + 0.01 * np.arange(50)])
    path = tmp_path / "leaps.npz"
    np.savez(path, t=t, q1=t, q2=t)
    found = read_trials(path, ARM, ["q"])
    assert [len(signals["t"]) for signals in found.signals.values()] == [50, 50]
    assert [note.row for note in found.notes] == [51, 52]
    for signals in found.signals.values():
        np.testing.assert_allclose(signals["t"], 0.01 * np.arange(50), atol=1e-9)
