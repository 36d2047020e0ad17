"""`fitter dynamics`: its other ways to learn."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Control

INERTIAL = ("I1+m2*L1^2", "m2*sx2", "I2")


def values(document):
    return {name: p["value"] for name, p in document["parameters"].items()}


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


def test_options_that_no_gains_are_learnt_by_are_refused(fitter, trial_files, tmp_path):
    """All of them in one sentence: who asks for possible masses must not get others."""
    common = ("dynamics", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    outcome = fitter(*common, "--unknown-gains", "--physical", "--bounds", "I2=0:1", "--compare", "dd-arm")
    assert outcome.code == 2 and "--bounds, --physical, --compare: not heeded with --unknown-gains" in outcome.said
    outcome = fitter(*common, "--no-torque", "--payload", "0.5:1")
    assert outcome.code == 2 and "--payload: not heeded with --no-torque" in outcome.said


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
