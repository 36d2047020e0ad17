"""`fitter simulate`."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.kinematics import tip_position
from arm.model import Control, Effect
from fitter.data.motion_file import write_motion
from fitter.data.motions import read_motions
from fitter.data.trials import load_trials
from protocol.tables.columns import parse_mapping


@pytest.fixture(scope="module")
def reference(short_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("reference") / "targets.npz"
    write_motion(path, short_run.motion_columns([1, 2, 3], 4, "ddq", "tau"))
    return path


def angles(path):
    columns = np.load(path)
    return np.column_stack([columns["q1"], columns["q2"]])


def test_the_motion_is_the_arms_own(fitter, reference, tmp_path):
    out = tmp_path / "motion.npz"
    outcome = fitter("simulate", "--arm", "dd-arm", "--reference", reference, "--out", out)
    assert outcome.code == 0
    columns = np.load(out)
    samples = len(np.load(reference)["t"])
    assert outcome.document == {"out": str(out), "trials": 3, "samples": samples, "scheme": "rk4", "notes": []}
    assert set(columns) == {
        *("t", "trial", "tipx", "tipy", "tipz"),
        *(f"{name}{j}" for name in ("q", "dq", "ddq", "tau", "ref") for j in (1, 2)),
    }
    assert np.allclose(columns["t"], np.load(reference)["t"], atol=1e-9)
    assert np.rad2deg(np.abs(angles(out) - angles(reference))).max() < 0.01
    assert len(load_trials([out], 2)) == 3


def test_the_same_reference_gives_the_same_bytes(fitter, reference, tmp_path):
    outs = [tmp_path / "1.csv", tmp_path / "2.csv"]
    for out in outs:
        fitter("simulate", "--arm", "dd-arm", "--reference", reference, "--out", out)
    assert outs[0].read_bytes() == outs[1].read_bytes()


def test_the_papers_scheme_lags(fitter, reference, tmp_path):
    out = tmp_path / "motion.npz"
    document = fitter(
        "simulate", "--arm", "dd-arm", "--reference", reference, "--scheme", "paper", "--out", out
    ).document
    assert document["scheme"] == "paper"
    error = np.rad2deg(np.abs(angles(out) - angles(reference))).max()
    assert 0.01 < error < 5.0


def test_a_coarse_reference_is_simulated_finely(fitter, short_run, tmp_path):
    """Targets at 20 Hz; the arm itself is carried on in steps of a millisecond."""
    coarse, out = tmp_path / "targets.csv", tmp_path / "motion.npz"
    write_motion(coarse, short_run.motion_columns([1], 200, "dq", "ddq", "tau"))
    assert fitter("simulate", "--arm", "dd-arm", "--reference", coarse, "--out", out).code == 0
    truth = short_run.truth["q"][:27000:200]
    assert np.rad2deg(np.abs(angles(out) - truth)).max() < 3.0  # the target jumps at one of these samples


@pytest.mark.parametrize("suffix", ["csv", "npz", "parquet"])
def test_trials_keep_their_names(fitter, short_run, tmp_path, suffix):
    targets, out = tmp_path / "targets.npz", tmp_path / f"motion.{suffix}"
    columns = short_run.motion_columns([1, 2], 200, "dq", "ddq", "tau")
    names = np.where(columns["trial"] == columns["trial"][0], "slow", "fast")
    write_motion(targets, {**columns, "trial": names})
    assert fitter("simulate", "--arm", "dd-arm", "--reference", targets, "--out", out).code == 0
    found = read_motions(out, 2, parse_mapping(None, 2), None, ("q",))
    assert [motion.name for motion in found] == ["motion/slow", "motion/fast"]


def test_without_angles_it_starts_at_rest_at_the_target(fitter, short_run, tmp_path):
    targets, out = tmp_path / "targets.csv", tmp_path / "motion.npz"
    write_motion(targets, {"t": short_run.t[:8000:4], "ref": short_run.truth["ref"][:8000:4] + 0.2})
    assert fitter("simulate", "--arm", "dd-arm", "--reference", targets, "--out", out).code == 0
    assert np.allclose(angles(out)[0], 0.2)
    outcome = fitter("simulate", "--arm", "dd-arm", "--reference", targets, "--initial-q", "1,-1", "--out", out)
    assert outcome.code == 0 and np.allclose(angles(out)[0], [1.0, -1.0])


def test_measured_torque_drives_where_the_law_says_so(fitter, short_run, tmp_path):
    save_arm(replace(short_run.arm, control=Control("measured")), tmp_path / "arm.toml")
    rows = slice(2000, 6000)
    columns = {name: short_run.truth[name][rows] for name in ("q", "dq", "tau")}
    write_motion(tmp_path / "torque.npz", {"t": short_run.t[rows], **columns})
    out = tmp_path / "motion.npz"
    arm, reference = tmp_path / "arm.toml", tmp_path / "torque.npz"
    assert fitter("simulate", "--arm", arm, "--reference", reference, "--out", out).code == 0
    assert np.rad2deg(np.abs(angles(out) - columns["q"])).max() < 0.1
    undriven = tmp_path / "undriven.npz"
    write_motion(undriven, {"t": short_run.t[rows], "q": columns["q"]})
    outcome = fitter("simulate", "--arm", arm, "--reference", undriven, "--out", out)
    assert outcome.code == 2 and "no column 'tau1'" in outcome.errors[0]
    free = tmp_path / "free.npz"
    write_motion(free, {"t": short_run.t[rows], "tau": columns["tau"]})
    outcome = fitter("simulate", "--arm", arm, "--reference", free, "--out", out)
    assert outcome.code == 2 and "expected them or --initial-q for arm dd-arm" in outcome.errors[0]


def test_irregular_sampling_is_resampled_and_said(fitter, short_run, tmp_path):
    columns = short_run.motion_columns([1], 8, "ddq", "tau")
    kept = np.sort(np.random.default_rng(0).choice(len(columns["t"]), len(columns["t"]) - 100, replace=False))
    write_motion(tmp_path / "ref.csv", {name: values[kept] for name, values in columns.items()})
    arguments = ("--arm", "dd-arm", "--reference", tmp_path / "ref.csv", "--out", tmp_path / "m.npz")
    outcome = fitter("simulate", *arguments)
    assert outcome.code == 0 and "resampled to 2 ms" in outcome.said


def test_an_arm_that_runs_away_is_not_written(fitter, short_run, tmp_path):
    pushed = replace(short_run.arm, control=Control("pd", (9.5, 9.5), (2000.0, 2000.0)))
    save_arm(pushed, tmp_path / "arm.toml")
    reference, out = tmp_path / "short.npz", tmp_path / "motion.npz"
    rows = slice(2000, 4000)
    columns = {name: short_run.truth[name][rows] for name in ("q", "ref")}
    write_motion(reference, {"t": short_run.t[rows], **columns})
    outcome = fitter("simulate", "--arm", tmp_path / "arm.toml", "--reference", reference, "--out", out)
    assert outcome.code == 2 and "the simulation runs away to infinity" in outcome.errors[0]
    assert not out.exists()


def test_the_tip_is_the_arms_whose_zero_is_off(fitter, reference, tmp_path):
    arm = load_arm("dd-arm")
    save_arm(replace(arm, effects=(Effect("joint_zero", {"offset_rad": 0.3}, (2,)),)), tmp_path / "arm.toml")
    out = tmp_path / "m.npz"
    assert fitter("simulate", "--arm", tmp_path / "arm.toml", "--reference", reference, "--out", out).code == 0
    tip = np.column_stack([np.load(out)[f"tip{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(tip, tip_position(arm, angles(out) + [0.0, 0.3]), rtol=0, atol=1e-12)
