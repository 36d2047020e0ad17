"""Columns of the drives: engaged or let go, and gains of a trial's own."""

import numpy as np
import pytest

from arm.model import Control
from fitter.data.drives import let_go
from fitter.data.law_torque import law_torque
from fitter.data.motion_file import write_motion
from fitter.data.motions import Measured
from fitter.data.resample import resample
from fitter.data.trial import undriven
from fitter.data.trial_filter import lowpass_trial
from fitter.data.trials import load_trials, to_trials
from limbcal.errors import DataError

T = 0.002 * np.arange(2000)
Q = np.column_stack([np.sin(3.0 * T), np.cos(2.0 * T)])
REF = 0.5 * Q
ON = np.column_stack([(T < 2.0), np.ones(len(T))]).astype(float)
TAU = np.column_stack([np.cos(3.0 * T), np.ones(len(T))])


def read(tmp_path, columns, **more):
    write_motion(tmp_path / "run.csv", {"t": T, **columns})
    return load_trials([tmp_path / "run.csv"], 2, **more)[0]


def test_a_trial_carries_its_drives(tmp_path):
    trial = read(tmp_path, {"q": Q, "ref": REF, "on": ON, "kp": np.tile([9.0, 4.0], (len(T), 1))}, cutoff_hz=15.0)
    inner = slice(trial.trimmed, trial.trimmed + len(trial.t))
    assert trial.trimmed and np.array_equal(trial.drives.on, ON[inner] > 0.5)
    assert np.all(trial.drives.kp == [9.0, 4.0]) and trial.drives.kv is None
    assert np.array_equal(trial.whole["on"], ON)
    shorter = lowpass_trial(trial, 20.0)
    assert shorter.drives.on.shape == shorter.q.shape
    assert undriven(trial).drives is None and "on" not in undriven(trial).whole


@pytest.mark.parametrize("derivatives", [False, True])
def test_a_drive_that_is_let_go_has_no_torque(tmp_path, derivatives):
    more = {"dq": Q, "ddq": Q} if derivatives else {}
    trial = read(tmp_path, {"q": Q, "tau": TAU, "on": ON, **more})
    off = ~trial.drives.on
    assert off[:, 0].any() and not trial.tau_measured[off].any()
    assert np.array_equal(trial.tau_measured[~off], TAU[trial.trimmed : len(T) - trial.trimmed][~off])
    (note,) = [note for note in trial.notes if note.kind == "let_go"]
    assert note.columns == ("on1", "tau1") and "joint 1 is let go in 1000 of 2000 samples" in note.text


def test_switches_are_those_of_the_nearest_sample():
    t = np.cumsum(np.random.default_rng(5).uniform(0.5, 1.5, 400)) * 0.01
    on, kp = (t[:, None] > 2.0).astype(float), np.where(t[:, None] > 1.0, 8.0, 1.0)
    motion = Measured("run", "run.csv", 0, t, {"q": np.sin(t)[:, None], "on": on, "kp": kp})
    for rate_hz in (None, 20.0, 317.0):
        uniform = resample(motion, rate_hz).measured
        nearest = np.abs(uniform.t[:, None] + t[0] - t).argmin(axis=1)
        assert np.array_equal(uniform.columns["on"], on[nearest])
        assert np.array_equal(uniform.columns["kp"], kp[nearest])


def test_what_is_no_switch_is_said(tmp_path):
    wrong = ON.copy()
    wrong[6, 1] = 0.5
    with pytest.raises(DataError, match=r"run.csv: on2 in row 7 is 0.5, expected 1 where the drive is engaged"):
        read(tmp_path, {"q": Q, "on": wrong})


def test_the_torque_of_a_law_is_filtered_as_the_motion_is():
    """A joint that moves freely from 2 s on: what the law asks for is the low-passed jump, half a step late."""
    control, gain = Control("pd", (5.0, 3.0), (-0.2, -0.1)), np.tile([8.0, 3.0], (len(T), 1))
    columns = {"q": Q, "ref": REF}
    switched, plain, with_switch = (
        to_trials([Measured("run", "run.csv", 0, T, columns | more)], cutoff_hz=15.0)[0]
        for more in ({"on": ON, "kp": gain}, {}, {"kp": np.tile(control.kp, (len(T), 1))})
    )
    known, found = (law_torque(control, trial) for trial in (plain, with_switch))
    assert np.allclose(known, found, atol=1e-9)  # gains that are the law's own change nothing
    tau = law_torque(control, switched)
    away = np.abs(T[switched.trimmed : len(T) - switched.trimmed] - 2.0) > 0.15
    own = law_torque(Control("pd", (8.0, 3.0), control.kv), plain)
    assert np.allclose(tau[:, 1], own[:, 1], atol=1e-9)
    assert np.allclose(tau[away, 0], (own * switched.drives.on)[away, 0], atol=2e-3)
    jump = np.abs(np.diff(tau[:, 0])).max()
    assert jump < 0.3 * np.abs(np.diff(own[:, 0] * switched.drives.on[:, 0])).max()


def test_trials_of_a_set_may_differ_in_everything(tmp_path):
    """Irregular, of unequal length, with and without derivatives, each with gains of its own."""
    rng = np.random.default_rng(2)
    for k, n in enumerate((700, 1500, 2000)):
        t = T[:n] + 4e-4 * rng.uniform(-1.0, 1.0, n) * (k > 0)
        q = np.column_stack([np.sin(3.0 * t), np.cos(2.0 * t)])
        columns = {"t": t, "q": q, "ref": 0.5 * q, "kp": np.full((n, 2), 1.0 + k)}
        columns |= {"dq": np.gradient(q, t, axis=0)} if k == 1 else {}
        write_motion(tmp_path / f"run{k}.csv", columns)
    trials = load_trials([tmp_path], 2)
    assert [trial.drives.kp[0, 0] for trial in trials] == [1.0, 2.0, 3.0]
    assert len({len(trial.t) for trial in trials}) == 3 and len({trial.cutoff_hz for trial in trials}) == 1
    for trial in trials:
        assert np.allclose(
            law_torque(Control("p", (9.0, 9.0)), trial), -0.5 * trial.drives.kp * trial.q, atol=2e-2
        )


def test_each_joint_that_is_let_go_is_noted_with_its_torque():
    on = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    tau = np.array([[1.0, -7.0], [2.0, 5.0], [3.0, -9.0]])
    found, (note,) = let_go({"on": on, "tau": tau}, "run.csv")
    assert found["tau"].tolist() == [[1.0, 0.0], [2.0, 0.0], [3.0, -9.0]]
    assert tau[0, 1] == -7.0 and found["on"] is on
    assert note.text == (
        "the drive of joint 2 is let go in 2 of 3 samples: its torque, up to 7 there, counts as 0"
    )
    assert (note.kind, note.source, note.columns) == ("let_go", "run.csv", ("on2", "tau2"))
    both = let_go({"on": 0.0 * on, "tau": tau}, "run.csv")[1]
    assert [note.columns for note in both] == [("on1", "tau1"), ("on2", "tau2")]


def test_without_switch_or_torque_nothing_is_let_go():
    values = np.ones((3, 2))
    for columns in ({"tau": values}, {"on": 0.0 * values}, {"on": values, "tau": values}):
        found, notes = let_go(columns, "run.csv")
        assert notes == () and found.keys() == columns.keys()
        assert all(np.array_equal(found[role], columns[role]) for role in columns)
