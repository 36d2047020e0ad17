"""`fitter excite`."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.model import Control

QUICK = ("--trials", "2", "--seconds", "2.5", "--rate-hz", "200", "--population", "10", "--generations", "2")


def test_the_file_is_what_simulate_reads_and_the_document_what_is_promised(fitter, tmp_path):
    out, moved = tmp_path / "reference.npz", tmp_path / "motion.npz"
    outcome = fitter("excite", "--arm", "dd-arm", "--kind", "points", *QUICK, "--out", out)
    assert outcome.code == 0
    document = outcome.document
    assert list(document) == [
        *("out", "arm", "kind", "law", "trials", "seconds", "rate_hz", "samples", "torque_noise"),
        *("condition_number", "relative_std", "limits", "reached"),
    ]
    assert document["out"] == str(out)
    assert document["samples"] == 1000
    assert document["torque_noise"]["share"] == 0.01
    assert set(document["relative_std"]["I2"]) == set(document["condition_number"]) == {"suggested", "random"}
    for name in ("angle_deg", "speed", "torque"):
        assert np.all(np.array(document["reached"][name]) <= np.array(document["limits"][name]))
        assert document["limits"]["given"][name] is False
    assert "predicted standard errors, 1% noise of the torque" in " ".join(outcome.said.split())

    simulated = fitter("simulate", "--arm", "dd-arm", "--reference", out, "--out", moved)
    assert simulated.code == 0
    assert simulated.document["trials"] == 2
    asked, came = np.load(out), np.load(moved)
    for name in ("ref1", "ref2"):
        assert np.array_equal(asked[name], came[name])
    for name in ("q1", "q2"):
        assert np.allclose(asked[name], came[name], atol=1e-9)


def test_the_same_seed_gives_the_same_bytes(fitter, tmp_path):
    outs = [tmp_path / "1.csv", tmp_path / "2.csv"]
    for out in outs:
        arguments = ("--arm", "dd-arm", *QUICK, "--kind", "points", "--seed", "3")
        assert fitter("excite", *arguments, "--out", out).code == 0
    assert outs[0].read_bytes() == outs[1].read_bytes()


def test_measured_torque_drives_the_suggestion(fitter, tmp_path):
    save_arm(replace(load_arm("dd-arm"), control=Control()), tmp_path / "arm.toml")
    ref, out = tmp_path / "ref.parquet", tmp_path / "motion.npz"
    arguments = ("--arm", tmp_path / "arm.toml")
    assert fitter("excite", *arguments, *QUICK, "--kind", "points", "--out", ref).code == 0
    assert fitter("simulate", *arguments, "--reference", ref, "--out", out).code == 0
    moved = np.load(out)
    assert np.abs(moved["q1"] - moved["ref1"]).max() < 0.05


def test_limits_and_names(fitter, tmp_path):
    out = tmp_path / "ref.npz"
    given = ("--max-angle-deg", "40,20", "--max-speed", "0.5", "--max-torque", "4", "--reveal", "I2,m2*sx2")
    outcome = fitter("excite", "--arm", "dd-arm", *QUICK, *given, "--out", out)
    assert outcome.code == 0
    assert outcome.document["limits"]["angle_deg"] == pytest.approx([40.0, 20.0])
    assert outcome.document["limits"]["speed"] == [0.5, 0.5]
    assert outcome.document["limits"]["given"] == {"angle_deg": True, "speed": True, "torque": True}
    for wrong, said in (
        (("--reveal", "I9"), "no base parameter is called I9"),
        (("--max-speed", "1,2,3"), "--max-speed has 3 numbers"),
        (("--max-torque", "-1"), "expected numbers above 0"),
    ):
        outcome = fitter("excite", "--arm", "dd-arm", *QUICK, *wrong, "--out", out)
        assert outcome.code == 2
        assert said in outcome.errors[0]
    assert fitter("excite", "--arm", "dd-arm", *QUICK, "--out", tmp_path / "ref.txt").code == 2


def test_what_slides_goes_metres_and_is_pushed_by_newtons(fitter, tmp_path):
    arm = load_arm("dd-arm")
    slides = replace(arm, joints=(replace(arm.joints[0], type="prismatic"), arm.joints[1]), control=Control())
    save_arm(slides, tmp_path / "arm.toml")
    limits = ("--max-angle-deg", "0.25,60", "--max-speed", "9", "--max-torque", "900")
    given = ("--arm", tmp_path / "arm.toml", "--kind", "points", *QUICK, *limits)
    outcome = fitter("excite", *given, "--out", tmp_path / "ref.csv")
    assert outcome.code == 0
    assert "of at most 0.25 m, 60°, 9 m/s, 9 rad/s, 900 N, 900 N·m" in outcome.said
