"""Data that are not there, not what they should be, or tell nothing."""

import numpy as np
import pytest

import fitter.__main__
from fitter.data.motion_file import write_motion

COMMANDS = [("kinematics", "--out", "arm.toml"), ("dynamics", "--out", "arm.toml"), ("track", "--out", "m.npz")]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_data_that_does_not_exist(said, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    name, *out = command
    here = (name, "--arm", "dd-arm", *out)
    assert said(2, *here, "nothing.csv") == "nothing.csv: there is no such file or folder"
    (tmp_path / "empty").mkdir()
    assert "empty: no data file in this folder, expected .csv" in said(2, *here, "empty")
    (tmp_path / "notes.txt").write_text("q1, q2")
    assert "notes.txt: the suffix is '.txt', expected one of .csv" in said(2, *here, "notes.txt")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "notes.txt"]


@pytest.mark.parametrize("suffix", ["csv", "parquet", "npz", "mat", "json", "mcap"])
def test_data_that_is_not_what_its_name_says(said, tmp_path, suffix):
    path = tmp_path / f"noise.{suffix}"
    path.write_bytes(np.random.default_rng(0).bytes(1000))
    for command in ("kinematics", "dynamics"):
        sentence = said(2, command, path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
        assert sentence.startswith(str(path))
    path.write_bytes(b"")
    assert said(2, "dynamics", path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml").startswith(str(path))


def test_columns_that_are_not_there(said, motion, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    among = "among its columns t, q1, q2, ref1, ref2"
    assert said(2, *fit, "--columns", "q=angle{j}") == f"{motion}: no column 'angle1' {among}"
    assert said(2, *fit, "--columns", "tau=torque_{j}") == f"{motion}: no column 'torque_1' {among}"
    track = ("track", motion, "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert said(2, *track) == f"{motion}: no column 's1x' {among}"
    simulate = ("simulate", "--reference", motion, "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert "no column 'goal1'" in said(2, *simulate, "--columns", "ref=goal{j}")


def test_every_mistake_in_a_mapping_is_named(run, motion, tmp_path):
    fit = ("dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    outcome = run(fitter.__main__.main, *fit, "--columns", "q=angle,time=t,q9=a,oops")
    assert outcome.code == 2 and len(outcome.errors) == 4
    for entry, error in zip(("q=angle", "time=t", "q9=a", "oops"), outcome.errors, strict=True):
        assert error.startswith(f"error: --columns, entry '{entry}': ")


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
def test_a_value_that_is_not_a_number(said, columns, tmp_path, suffix):
    path = tmp_path / f"motion{suffix}"
    q = columns["q"].copy()
    q[41, 1] = np.nan
    write_motion(path, columns | {"q": q})
    for command in ("dynamics", "kinematics"):
        sentence = said(2, command, path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
        assert sentence.startswith(str(path)) and "q2" in sentence and "row 42: " in sentence
        assert sentence.endswith("found nothing or NaN, expected a finite number")
    sentence = said(2, "simulate", "--reference", path, "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert "q2" in sentence and "row 42: " in sentence


def test_words_where_a_number_should_be(said, motion, tmp_path):
    lines = motion.read_text().splitlines()
    lines[10] = lines[10].replace(",", ",oops", 1)
    motion.write_text("\n".join(lines))
    sentence = said(2, "dynamics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert sentence.startswith(f"{motion}: row 10: column 'q1' holds 'oops")


def test_time_that_runs_backwards_or_stands_still(said, columns, tmp_path):
    path, t = tmp_path / "motion.csv", columns["t"].copy()
    for wrong, word in ((t[50], "runs backwards from"), (t[99], "stands still at")):
        t[100] = wrong
        write_motion(path, columns | {"t": t})
        for command in (
            ("dynamics", path, "--out", tmp_path / "arm.toml"),
            ("simulate", "--reference", path, "--out", tmp_path / "m.npz"),
        ):
            sentence = said(2, *command, "--arm", "dd-arm")
            assert sentence.startswith(f"{path}: in row 101 time {word}")


def test_readings_whose_time_runs_backwards(said, short_run, tmp_path):
    raw = {name: values[:1000].copy() for name, values in short_run.raw_columns().items()}
    raw["t"][500] = 0.0
    write_motion(tmp_path / "raw.npz", raw)
    sentence = said(2, "track", tmp_path / "raw.npz", "--arm", "dd-arm", "--out", tmp_path / "m.npz")
    assert sentence.startswith(f"{tmp_path / 'raw.npz'}: in row 501 time runs backwards from")


def test_a_trial_too_short(said, columns, short_run, tmp_path):
    path = tmp_path / "motion.csv"
    write_motion(path, {name: values[:10] for name, values in columns.items()})
    expected = f"{path}: trial 'motion' has 10 samples, expected at least 16"
    for command in ("dynamics", "kinematics"):
        assert said(2, command, path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml") == expected
    assert said(2, "simulate", "--reference", path, "--arm", "dd-arm", "--out", tmp_path / "m.npz") == expected
    write_motion(tmp_path / "raw.csv", {name: values[:10] for name, values in short_run.raw_columns().items()})
    for command in ("track", "sensors"):
        sentence = said(2, command, tmp_path / "raw.csv", "--arm", "dd-arm", "--out", tmp_path / "m.npz")
        assert sentence == f"{tmp_path / 'raw.csv'}: run 'raw' has 10 samples, expected at least 16"


def test_more_joints_than_the_arm_has(said, columns, tmp_path):
    path = tmp_path / "motion.csv"
    write_motion(path, columns | {"q": np.tile(columns["q"], (1, 2)), "ref": np.tile(columns["ref"], (1, 2))})
    sentence = said(2, "dynamics", path, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert sentence == f"{path}: there is a column 'q3', but the arm has 2 joints"


def test_trials_that_are_learnt_from_cannot_evaluate(said, motion, tmp_path):
    for command in ("dynamics", "kinematics"):
        arguments = (command, motion, "--evaluate", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
        assert said(2, *arguments) == f"--evaluate: {motion} is learnt from, expected trials that are not"


def test_a_law_of_measured_torque_needs_torque(said, motion, measuring, tmp_path):
    sentence = said(2, "dynamics", motion, "--arm", measuring, "--out", tmp_path / "arm.toml")
    assert sentence.startswith("trial motion: has no torque, but control.law of arm dd-arm is 'measured'")
    sentence = said(2, "simulate", "--reference", motion, "--arm", measuring, "--out", tmp_path / "m.npz")
    assert sentence.startswith(f"{motion}: no column 'tau1' among")


def test_a_motion_without_a_tip_tells_no_geometry(said, motion, tmp_path):
    sentence = said(2, "kinematics", motion, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert sentence == "trial motion: has no tip; expected columns tipx, tipy and tipz"


def test_a_trial_in_which_nothing_moves_answers_nothing(said, columns, measuring, tmp_path):
    still = {name: values if name == "t" else np.full_like(values, 0.3) for name, values in columns.items()}
    tip, tau = np.full((len(still["t"]), 3), 0.5), np.ones_like(still["q"])
    path, out = tmp_path / "still.csv", tmp_path / "arm.toml"
    write_motion(path, still | {"tip": tip, "tau": tau})
    samples = len(tip)
    sentence = said(4, "kinematics", path, "--arm", "dd-arm", "--out", out)
    assert sentence.startswith(f"no geometric parameter can be identified from {samples} samples")
    for arm in ("dd-arm", measuring):
        sentence = said(4, "dynamics", path, "--arm", arm, "--out", out)
        assert f"{samples} samples" in sentence
    assert not out.exists()


def test_a_search_that_is_cut_short_is_no_answer(said, trial_files, tmp_path):
    fit = ("dynamics", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--generations", "2")
    assert said(4, *fit).startswith("after 2 generations of 100 the cost ")
    assert not (tmp_path / "arm.toml").exists()
