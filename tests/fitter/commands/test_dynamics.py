"""`fitter dynamics`."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Control, Link
from fitter.data.motion_file import write_motion

NAMES = ["I1+m2*L1^2", "m2*sx2", "m2*sy2", "I2", "D1", "D2", "fc1", "fc2", "F1", "F2"]
TRUE = [1.986076, 1.718632, 0.181763, 0.471209, -0.002409, 0.000311, 0.010918, -0.002271]
KEYS = {
    *("parameters", "method", "generations", "samples", "seconds", "condition_number", "torque_rms_N_m"),
    *("angle_error_deg", "objective", "ci95", "angle_rms_deg", "explained", "notes", "identifiability"),
}


@pytest.fixture(scope="module")
def guess(short_run, tmp_path_factory):
    """Write an arm file that knows no masses; its law is eq. (5)."""
    path = tmp_path_factory.mktemp("arms") / "guess.toml"
    joints = [replace(joint, link=Link()) for joint in short_run.arm.joints]
    save_arm(replace(short_run.arm, name="guess", joints=tuple(joints)), path)
    return path


@pytest.fixture(scope="module")
def measuring(guess, tmp_path_factory):
    """Write the same arm, but the torque comes with the data."""
    path = tmp_path_factory.mktemp("arms") / "measuring.toml"
    save_arm(replace(load_arm(guess), control=Control("measured")), path)
    return path


def test_the_document_is_the_contracts(fitter, trial_files, guess, tmp_path):
    learn, evaluate = trial_files
    out = tmp_path / "arm.toml"
    outcome = fitter("dynamics", learn, "--evaluate", evaluate, "--arm", guess, "--out", out)
    assert outcome.code == 0
    document = outcome.document
    assert set(document) == KEYS
    assert list(document["parameters"]) == NAMES
    assert all(set(p) == {"value", "std", "unit", "identifiable"} for p in document["parameters"].values())
    values = [document["parameters"][name]["value"] for name in NAMES[:8]]
    assert np.allclose(values, TRUE, rtol=1e-3, atol=1e-4)
    assert document["parameters"]["F1"] == {"value": 0.0, "std": None, "unit": "N m", "identifiable": False}
    assert document["method"] == "ga" and 0 < document["generations"] < 1000
    assert document["samples"] <= 2 * 3375 and document["seconds"] > 0.0 and document["condition_number"] > 1.0
    assert set(document["torque_rms_N_m"]) == set(document["angle_error_deg"]) == {"learn", "evaluate"}
    assert all(len(rms) == 2 and max(rms) < 1e-3 for rms in document["torque_rms_N_m"].values())
    assert all(set(error) == {"mean", "max"} for error in document["angle_error_deg"].values())
    assert document["angle_error_deg"]["evaluate"]["max"] < 0.05
    assert "evaluating: torque rms" in outcome.said
    assert list(load_arm(out).base_parameters) == NAMES[:8]


def test_without_evaluating_trials_that_part_is_null(fitter, trial_files, guess, tmp_path):
    document = fitter("dynamics", trial_files[0], "--arm", guess, "--out", tmp_path / "arm.toml").document
    assert document["torque_rms_N_m"]["evaluate"] is None and document["angle_error_deg"]["evaluate"] is None


def test_the_same_seed_gives_the_same_bytes_and_another_the_same_arm(fitter, trial_files, guess, tmp_path):
    written, values = [], []
    for number, seed in enumerate((3, 3, 4)):
        out = tmp_path / f"{number}.toml"
        document = fitter("dynamics", trial_files[0], "--arm", guess, "--seed", seed, "--out", out).document
        written.append(out.read_bytes())
        values.append([document["parameters"][name]["value"] for name in NAMES])
    assert written[0] == written[1]
    assert np.allclose(values[0], values[2], rtol=1e-4, atol=1e-5)


def test_the_search_finds_what_least_squares_finds(fitter, trial_files, guess, tmp_path):
    common = ("dynamics", trial_files[0], "--arm", guess, "--out", tmp_path / "arm.toml")
    searched, solved = fitter(*common).document, fitter(*common, "--method", "least-squares").document
    assert (solved["method"], solved["generations"]) == ("least-squares", 0)
    for name in NAMES:
        assert searched["parameters"][name]["value"] == pytest.approx(
            solved["parameters"][name]["value"], rel=1e-4, abs=1e-5
        )


def test_the_measured_torque_where_the_law_says_so(fitter, trial_files, measuring, tmp_path):
    learn, evaluate = trial_files
    arguments = ("--evaluate", evaluate, "--arm", measuring, "--horizon", "0.25", "--out", tmp_path / "arm.toml")
    document = fitter("dynamics", learn, *arguments).document
    values = [document["parameters"][name]["value"] for name in NAMES[:8]]
    assert np.allclose(values, TRUE, rtol=1e-2, atol=1e-3)
    assert document["angle_error_deg"]["evaluate"]["max"] < 0.1


def test_restricted_conditions(fitter, trial_files, guess, tmp_path):
    restricted = ("--fix", "D1=0,D2=0.5", "--bounds", "I2=0.3:0.6", "--population", "40", "--generations", "400")
    document = fitter(
        "dynamics", trial_files[0], "--arm", guess, "--out", tmp_path / "arm.toml", *restricted
    ).document
    assert 0 < document["generations"] <= 400
    assert document["parameters"]["D2"]["value"] == 0.5 and not document["parameters"]["D2"]["identifiable"]


def test_a_recording_gives_both_sets(fitter, recording, guess, tmp_path):
    outcome = fitter("dynamics", recording, "--arm", guess, "--out", tmp_path / "arm.toml")
    assert outcome.code == 0
    document = outcome.document
    assert document["parameters"]["I2"]["value"] == pytest.approx(0.471209, rel=0.02)
    assert document["angle_error_deg"]["evaluate"]["mean"] < 0.5
    assert "drift taken out by the rest" in outcome.said
    in_folder = fitter("dynamics", recording.parent, "--arm", guess, "--out", tmp_path / "arm.toml").document
    assert {**in_folder, "seconds": 0} == {**document, "seconds": 0}


def test_another_arm_stands_beside(fitter, trial_files, guess, tmp_path):
    out = tmp_path / "arm.toml"
    outcome = fitter("dynamics", trial_files[0], "--arm", guess, "--compare", "dd-arm", "--out", out)
    assert set(outcome.document) == KEYS | {"compared"}
    compared = outcome.document["compared"]["dd-arm"]
    assert compared["parameters"]["I2"] == pytest.approx(0.471209)
    assert compared["torque_rms_N_m"]["learn"] == pytest.approx([0.0, 0.0], abs=1e-3)
    assert compared["torque_rms_N_m"]["evaluate"] is None
    assert "dd-arm, learning: torque rms" in outcome.said


def test_foreign_columns_and_irregular_sampling_are_mapped_and_said(fitter, short_run, measuring, tmp_path):
    columns = short_run.motion_columns([1, 2], 8, "ref", "ddq")
    kept = np.sort(np.random.default_rng(0).choice(len(columns["t"]), len(columns["t"]) - 200, replace=False))
    foreign = {"time": columns["t"], "run": columns["trial"]}
    for name, role in (("angle", "q"), ("speed", "dq"), ("torque", "tau")):
        foreign |= {f"{name}_{j}": columns[role][:, j] for j in (0, 1)}
    write_motion(tmp_path / "lab.csv", {name: values[kept] for name, values in foreign.items()})
    mapping = "t=time,trial=run,q=angle_{j-1},dq=speed_{j-1},tau=torque_{j-1}"
    out = tmp_path / "arm.toml"
    outcome = fitter("dynamics", tmp_path / "lab.csv", "--columns", mapping, "--arm", measuring, "--out", out)
    assert outcome.code == 0
    assert "resampled to 2 ms" in outcome.said and "ddq derived from dq" in outcome.said
    assert outcome.document["parameters"]["I2"]["value"] == pytest.approx(0.471209, rel=0.05)


def test_from_accelerations_to_a_simulated_motion(fitter, short_run, guess, tmp_path):
    """Track, learn the geometry, learn the dynamics, simulate: each reads what the one before wrote."""
    write_motion(tmp_path / "raw.npz", short_run.raw_columns())
    tracked, arm, calibrated = tmp_path / "motion.npz", tmp_path / "geometry.toml", tmp_path / "calibrated.toml"
    simulated = tmp_path / "simulated.npz"
    assert fitter("track", tmp_path / "raw.npz", "--arm", guess, "--out", tracked).code == 0
    assert fitter("kinematics", tracked, "--arm", guess, "--out", arm).code == 0
    learnt = fitter("dynamics", tracked, "--arm", arm, "--out", calibrated)
    assert learnt.code == 0
    assert learnt.document["parameters"]["I2"]["value"] == pytest.approx(0.471209, rel=0.02)
    assert fitter("simulate", "--arm", calibrated, "--reference", tracked, "--out", simulated).code == 0
    measured, moved = np.load(tracked), np.load(simulated)
    for joint in ("q1", "q2"):
        error = np.rad2deg(np.abs(measured[joint] - moved[joint]))
        assert error.mean() < 0.5 and error.max() < 3.0
