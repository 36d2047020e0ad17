"""`fitter diagnose`, from files to a page."""

import io
import itertools
import json
import os
import threading
import uuid
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, save_arm
from arm.model import Control, Effect
from arm.simulation import simulate
from fitter.__main__ import main
from fitter.data.motion_file import write_motion
from protocol.message import FRAMES, TRIAL, encode
from protocol.recording import RecordingWriter
from tests.fitter.commands.conftest import Outcome
from tests.fitter.dynamics.test_torque_wiring import driven
from tests.fitter.pendulum import columns, pendulum, swings

STIFFNESS, REST = 1.0, 0.3
SPRING = (Effect("joint_spring", {"stiffness_N_m_rad": STIFFNESS, "rest_angle_rad": REST}, joints=(1,)),)
FIELDS = "verdict causes candidates confusable next_experiment before after gain residual"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Write a pendulum with a spring that its arm file knows nothing of."""
    folder = tmp_path_factory.mktemp("pendulum")
    motions = swings(SPRING, trials=4)
    write_motion(folder / "learn.npz", columns(motions[:2]))
    write_motion(folder / "evaluate.csv", columns(motions[2:]))
    save_arm(pendulum(), folder / "arm.toml")
    return folder


def arguments(files, out, *more):
    learn, evaluate = files / "learn.npz", files / "evaluate.csv"
    return learn, "--evaluate", evaluate, "--arm", files / "arm.toml", "--out", out, *more


@pytest.fixture(scope="module")
def diagnosed(files):
    """Diagnose once, on one processor; return the folder and what was said."""
    out, answer, said = files / "new" / "out", io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(answer), redirect_stderr(said):
        patch.setattr(os, "sched_getaffinity", lambda _process: {0})
        code = main(["diagnose", *map(str, arguments(files, out)), "--json"])
    return out, Outcome(code, json.loads(answer.getvalue()), " ".join(said.getvalue().split()), [])


def test_the_cause_is_named_added_and_measured(diagnosed):
    out, outcome = diagnosed
    assert outcome.code == 0
    document = outcome.document
    assert set(FIELDS.split()) <= set(document)
    assert json.loads((out / "diagnosis.json").read_text()) == document
    assert document["verdict"] == "named"
    (cause,) = document["causes"]
    assert (cause["effect"], cause["joints"]) == ("joint_spring", [1])
    for name, true in (("stiffness_N_m_rad", STIFFNESS), ("rest_angle_rad", REST)):
        found = cause["parameters"][name]
        assert abs(found["value"] - true) < 4.0 * found["std"] + 0.02
    assert document["after"]["angle_error_deg"]["mean"] < 0.3 * document["before"]["angle_error_deg"]["mean"]
    assert document["candidates"][0]["effect"] == "joint_spring"
    low, high = document["gain"]["ci95"]
    assert low <= document["gain"]["torque"] <= high

    extended = load_arm(out / "extended.toml")
    assert [effect.name for effect in extended.effects] == ["joint_spring"]
    assert sorted(path.suffix for path in out.iterdir()) == [".html", ".json", *[".png"] * 4, ".toml"]
    for words in ("joint_spring, joint 1", "before", "after", "next: ", "report.html"):
        assert words in outcome.said


def test_trials_that_judge_have_no_say_in_anything(fitter, files, diagnosed, tmp_path):
    wrong = swings((Effect("viscous", {"viscous_N_m_s": 2.0}, joints=(1,)),), trials=2, seed=7)
    write_motion(tmp_path / "judge.csv", columns(wrong))
    write_motion(tmp_path / "like.csv", columns(swings(SPRING, trials=1, seed=8)))
    given = ("--judge", tmp_path / "judge.csv", tmp_path / "like.csv")
    with_them = fitter("diagnose", *arguments(files, tmp_path / "with", *given))
    _, without = diagnosed
    assert with_them.code == without.code == 0 and without.document["judged"] is None
    assert {**with_them.document, "judged": None} == without.document
    before, after = (with_them.document["judged"][when] for when in ("before", "after"))
    like, other = (after["sets"][str(tmp_path / name)] for name in ("like.csv", "judge.csv"))
    assert (
        like["angle_error_deg"]["rms"] < 0.3 * before["sets"][str(tmp_path / "like.csv")]["angle_error_deg"]["rms"]
    )
    assert other["torque_rms_N_m"][0] > 3.0 * like["torque_rms_N_m"][0]
    assert len(after["trials"]) == 3
    assert "on the trials that had no say" in with_them.said
    assert "on the trials that had no say" in (tmp_path / "with" / "report.html").read_text()


@pytest.fixture
def recorded_pendulum(tmp_path):
    """Record a pendulum going from rest to rest, as the daemon does: four times to learn from, two to judge."""
    arm, path, seq = pendulum(), tmp_path / "day.mcap", itertools.count()
    sensors = load_arm("dd-arm-vertical").sensors[:2]
    arm = replace(arm, sensors=sensors)
    rng, dt_s, t_ns = np.random.default_rng(3), 0.004, 7_000_000_000
    common = {"arm": arm.name, "run": str(uuid.uuid4())}
    save_arm(arm, tmp_path / "arm.toml")
    at = simulate(arm, np.zeros((1500, 1)), dt_s, np.zeros(1), np.zeros(1)).q[-1]
    with RecordingWriter(path, format_arm(arm), "") as writer:

        def write(topic, at_ns, **fields):
            writer.write(topic, encode(topic, {**fields, **common, "seq": next(seq)})[1], at_ns)

        for trial, target in enumerate((0.9, -0.4, 0.7, -1.1, 0.2, -0.8), 1):
            motion = simulate(arm, np.full((1000, 1), target), dt_s, at, np.zeros(1))
            n, at = len(motion.q), motion.q[-1]
            role = "learn" if trial <= 4 else "evaluate"
            write(TRIAL, t_ns, trial=trial, t_ns=t_ns, state="begin", role=role)
            frames = {
                **{
                    "frame0": (trial - 1) * n,
                    "t0_ns": t_ns,
                    "dt_s": dt_s,
                    "n": n,
                    "method": "filter",
                    "gap": False,
                },
                **{"q": motion.q + 1e-4 * rng.normal(size=motion.q.shape), "dq": motion.dq, "ddq": motion.ddq},
                **{"tip": np.zeros((n, 3)), "points": np.zeros((n, len(sensors), 3))},
            }
            write(FRAMES, t_ns, **frames)
            t_ns += round(1e9 * dt_s * n)
            end_ns = t_ns - round(1e9 * dt_s)
            write(TRIAL, end_ns, trial=trial, t_ns=end_ns, state="end", role=role)
    return path


def test_a_recording_is_diagnosed_as_the_daemon_wrote_it(fitter, recorded_pendulum, tmp_path):
    outcome = fitter("diagnose", recorded_pendulum, "--arm", tmp_path / "arm.toml", "--out", tmp_path)
    assert outcome.code == 0
    assert outcome.document["verdict"] in ("named", "ambiguous", "none", "unexplained")
    before = outcome.document["before"]
    assert all(np.isfinite(before["torque_rms_N_m"])) and before["angle_error_deg"]["mean"] < 2.0
    assert (tmp_path / "report.html").exists()


def test_files_that_mark_no_trial_as_evaluating_need_some(fitter, files, recording, tmp_path):
    outcome = fitter("diagnose", files / "learn.npz", "--arm", files / "arm.toml", "--out", tmp_path)
    assert outcome.code == 2
    (error,) = outcome.errors
    assert "--evaluate is missing, and" in error and "learn.npz marks no trial as evaluating" in error


def test_what_is_learnt_from_cannot_judge(fitter, files, tmp_path):
    given = arguments(files, tmp_path)
    outcome = fitter("diagnose", *given[:2], files / "learn.npz", *given[3:])
    assert outcome.code == 2
    assert outcome.errors == [
        f"error: --evaluate: {files / 'learn.npz'} is learnt from, expected trials that are not"
    ]


def test_a_friction_that_nobody_knows(fitter, files, tmp_path):
    outcome = fitter("diagnose", *arguments(files, tmp_path, "--deny", "viscous,air"))
    assert outcome.code == 2
    assert outcome.errors == ["error: --deny is 'viscous,air', expected some of viscous, coulomb"]


def test_trials_without_torque_and_law_say_nothing(fitter, files, tmp_path):
    save_arm(replace(pendulum(), control=Control("measured")), tmp_path / "arm.toml")
    given = list(arguments(files, tmp_path / "out"))
    given[4] = tmp_path / "arm.toml"
    outcome = fitter("diagnose", *given)
    assert outcome.code == 2 and len(outcome.errors) == 1
    assert "nothing says which torque drove it" in outcome.errors[0]
    assert not (tmp_path / "out" / "diagnosis.json").exists()


def test_a_torque_of_the_other_sign_is_named_and_no_arm_is_written(fitter, files, tmp_path):
    arm = replace(load_arm("dd-arm-vertical"), control=Control())
    save_arm(arm, tmp_path / "arm.toml")
    for name, seed in (("learn", 1), ("judge", 2)):
        trial = driven(arm, seed)
        write_motion(tmp_path / f"{name}.npz", {"t": trial.t, "q": trial.q, "tau": -trial.tau})
    given = (tmp_path / "learn.npz", "--evaluate", tmp_path / "judge.npz", "--arm", tmp_path / "arm.toml")
    outcome = fitter("diagnose", *given, "--out", tmp_path / "out")
    assert outcome.code == 4 and "the load's?" in outcome.errors[0]
    assert outcome.document["verdict"] == "unexplained" and outcome.document["notes"][-1]["kind"] == "impossible"
    assert (tmp_path / "out" / "diagnosis.json").exists() and not (tmp_path / "out" / "extended.toml").exists()


def test_a_place_that_cannot_be_written_to_is_told_first(fitter, files, tmp_path):
    (tmp_path / "file").write_text("")
    outcome = fitter("diagnose", *arguments(files, tmp_path / "file" / "below"))
    assert outcome.code == 3 and "cannot be made: Not a directory" in outcome.errors[0]


def test_the_same_trials_give_the_same_bytes_on_any_number_of_processors(
    fitter, files, diagnosed, tmp_path, monkeypatch
):
    on_one, _ = diagnosed
    monkeypatch.setattr(os, "sched_getaffinity", lambda _process: {0, 1, 2})
    monkeypatch.setattr(threading, "active_count", lambda: 1)  # those of who runs the tests do not count
    assert fitter("diagnose", *arguments(files, tmp_path)).code == 0
    for name in ("diagnosis.json", "extended.toml", "report.html"):
        assert (on_one / name).read_bytes() == (tmp_path / name).read_bytes(), name


def test_friction_that_the_model_was_denied_is_found(fitter, tmp_path):
    motions = swings((), trials=4)
    write_motion(tmp_path / "learn.npz", columns(motions[:2]))
    write_motion(tmp_path / "evaluate.csv", columns(motions[2:]))
    save_arm(pendulum(), tmp_path / "arm.toml")
    outcome = fitter("diagnose", *arguments(tmp_path, tmp_path / "out", "--deny", "viscous"))
    assert outcome.code == 0
    found = {cause["effect"]: cause["parameters"] for cause in outcome.document["causes"]}
    assert np.isclose(found["viscous"]["viscous_N_m_s"]["value"], 0.3, rtol=0.05)
