"""`fitter dynamics` from sums: like the motion, or no answer."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Control, Effect

INERTIAL = ("I1+m2*L1^2", "m2*sx2", "I2")


def values(document):
    return {name: p["value"] for name, p in document["parameters"].items()}


def test_sums_are_learnt_from_like_the_motion(fitter, trial_files, tmp_path):
    learn, evaluate = trial_files
    common = ("--arm", "dd-arm", "--objective", "torque", "--out", tmp_path / "arm.toml")
    motion = fitter("dynamics", learn, "--evaluate", evaluate, *common).document
    made = fitter("sums", "make", learn, "--arm", "dd-arm", "--out", tmp_path / "sums.npz")
    assert made.code == 0
    sums = fitter("dynamics", tmp_path / "sums.npz", *common).document
    parallel = fitter("dynamics", learn, "--workers", "2", *common).document
    for name in INERTIAL:
        assert values(sums)[name] == pytest.approx(values(motion)[name], rel=1e-9)
    assert values(sums) == values(parallel)
    assert sums["angle_error_deg"]["learn"] is None and max(sums["torque_rms_N_m"]["learn"]) < 0.01


def test_sums_that_explain_next_to_nothing_are_no_answer(fitter, tmp_path):
    rng, t = np.random.default_rng(3), np.arange(0.0, 6.0, 0.005)
    q = 0.5 * np.sin(2.0 * np.pi * np.outer(t, [0.5, 0.8]))
    columns = np.column_stack([t, q, rng.normal(size=q.shape)])
    path = tmp_path / "noise.csv"
    np.savetxt(path, columns, delimiter=",", header="t,q1,q2,tau1,tau2", comments="")
    save_arm(replace(load_arm("dd-arm"), control=Control()), tmp_path / "measured.toml")
    outcome = fitter(
        *("dynamics", path, "--arm", tmp_path / "measured.toml", "--out", tmp_path / "arm.toml"),
        *("--workers", "2", "--objective", "torque", "--method", "least-squares"),
    )
    assert outcome.code == 4 and "next to nothing" in outcome.said
    assert max(outcome.document["explained"]["learn"]) < 0.25


def test_sums_of_another_arm_are_refused(fitter, trial_files, tmp_path):
    fitter("sums", "make", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "sums.npz")
    outcome = fitter("dynamics", tmp_path / "sums.npz", "--arm", "dd-arm-vertical", "--out", tmp_path / "arm.toml")
    assert outcome.code == 2
    assert "of another arm or law" in outcome.said


def test_sums_hold_the_torque_of_effects_and_are_refused(fitter, trial_files, tmp_path):
    fitter("sums", "make", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "sums.npz")
    spring = Effect("joint_spring", {"stiffness_N_m_rad": 5.0, "rest_angle_rad": 0.2}, (2,))
    save_arm(replace(load_arm("dd-arm"), control=Control(), effects=(spring,)), tmp_path / "sprung.toml")
    outcome = fitter(
        *("dynamics", tmp_path / "sums.npz", "--arm", tmp_path / "sprung.toml", "--out", tmp_path / "arm.toml")
    )
    assert outcome.code == 2 and "whose torque is in the sums" in outcome.said


def test_processes_judge_by_the_same_trials_and_arms(fitter, trial_files, recording, tmp_path):
    common = ("--arm", "dd-arm", "--objective", "torque", "--method", "least-squares", "--compare", "dd-arm")
    held_back = ("--evaluate", trial_files[1])
    for data in ((recording,), (recording, *held_back), (trial_files[0], *held_back)):
        run = ("dynamics", *data, *common, "--out", tmp_path / "arm.toml")
        one, two = fitter(*run).document, fitter(*run, "--workers", "2").document
        assert values(two) == pytest.approx(values(one), rel=1e-6) and two["samples"] == one["samples"]
        for of_one, of_two in ((one, two), (one["compared"]["dd-arm"], two["compared"]["dd-arm"])):
            for name in ("torque_rms_N_m", "explained"):
                assert of_two[name]["evaluate"] == pytest.approx(of_one[name]["evaluate"], rel=1e-6)


def test_processes_learn_from_no_file_they_judge_by(fitter, trial_files, tmp_path):
    common = ("--arm", "dd-arm", "--workers", "2", "--out", tmp_path / "arm.toml")
    outcome = fitter("dynamics", trial_files[0], "--evaluate", trial_files[0], *common)
    assert outcome.code == 2 and "is learnt from, expected trials that are not" in outcome.said
