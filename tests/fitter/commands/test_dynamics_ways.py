"""`fitter dynamics`: its other ways to learn."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Control

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


def test_gains_are_learnt_up_to_one_factor(fitter, trial_files, tmp_path):
    arm = load_arm("dd-arm")
    save_arm(replace(arm, control=Control("pd", (4.0, 1.0), (-1.0, -1.0))), tmp_path / "wrong.toml")
    outcome = fitter(
        *("dynamics", trial_files[0], "--arm", tmp_path / "wrong.toml", "--out", tmp_path / "arm.toml"),
        *("--unknown-gains", "--fix", "I2=0.471209"),
    )
    found = values(outcome.document)
    assert found["kp1"] == pytest.approx(9.5, rel=0.02) and found["kp2"] == pytest.approx(9.5, rel=0.02)
    assert found["m2*sx2"] == pytest.approx(1.718632, rel=0.02)
    assert "I2" in outcome.document["fixed_by"]
    assert any("D1" in sentence and "kv1" in sentence for sentence in outcome.document["only_together"])
    assert outcome.document["law_misfit"]["fits"]
    assert min(outcome.document["explained"]["learn"]) > 0.9


@pytest.mark.parametrize(("given", "inertia"), [((), 0.471209), (("--fix", "I2=2"), 2.0)])
def test_a_swing_without_torque_has_one_number_for_its_scale(fitter, tmp_path, trial_files, given, inertia):
    common = ("dynamics", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--no-torque")
    outcome = fitter(*common, *given)
    assert values(outcome.document)["I2"] == pytest.approx(inertia)
    names = [ratio["name"] for ratio in outcome.document["ratios"]]
    assert "(m2*sx2)/I2" in names and "(K2)/I2" in names
    assert "with springs" in outcome.said


def test_outliers_and_weights_are_said(fitter, trial_files, tmp_path):
    arm = tmp_path / "measured.toml"
    save_arm(replace(load_arm("dd-arm"), control=Control()), arm)
    for objective in ("weighted", "robust"):
        outcome = fitter(
            *("dynamics", trial_files[0], "--arm", arm, "--objective", objective),
            *("--method", "least-squares", "--out", tmp_path / "arm.toml"),
        )
        assert outcome.document["objective"] == objective
        found = [values(outcome.document)[name] for name in INERTIAL]
        assert np.allclose(found, [1.986076, 1.718632, 0.471209], rtol=0.01)
