"""`fitter kinematics`."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from arm.kinematics import tip_position
from fitter.data.motion_file import write_motion

NAMES = [f"{name}{j}" for j in (1, 2) for name in ("alpha", "a", "d", "beta", "theta_offset")]
KEYS = {"parameters", "method", "generations", "samples", "seconds", "tip_error_mm"} | {
    "angle_noise_deg",
    "angle_noise_source",
    "about",
    "gauge",
    "explained",
    "ci95",
    "notes",
}


@pytest.fixture(scope="module")
def files(short_run, tmp_path_factory):
    """Write trials with a tip that is measured without an error: two to learn from, one to evaluate."""
    folder = tmp_path_factory.mktemp("tips")
    for name, trials in (("learn.npz", [1, 2]), ("evaluate.npz", [3])):
        columns = short_run.motion_columns(trials, 40, "tau", "ref")
        write_motion(folder / name, columns | {"tip": tip_position(short_run.arm, columns["q"])})
    return folder / "learn.npz", folder / "evaluate.npz"


@pytest.fixture(scope="module")
def guess(short_run, tmp_path_factory):
    """Write an arm file that knows no lengths."""
    path = tmp_path_factory.mktemp("arms") / "guess.toml"
    save_arm(short_run.arm.with_joints(a_m=np.array([0.5, 0.5])), path)
    return path


def test_a_tip_of_another_motion_is_no_answer(fitter, files, guess, short_run, tmp_path):
    columns = short_run.motion_columns([1, 2], 40, "tau", "ref")
    other = short_run.motion_columns([1, 2], 40)["q"][::-1]
    write_motion(tmp_path / "other.npz", columns | {"tip": tip_position(short_run.arm, other)[:, [2, 0, 1]]})
    outcome = fitter("kinematics", tmp_path / "other.npz", "--arm", guess, "--out", tmp_path / "arm.toml")
    assert outcome.code == 4 and "next to nothing of the tip's displacement is explained" in outcome.errors[0]


def test_the_document_is_the_contracts(fitter, files, guess, tmp_path):
    learn, evaluate = files
    out = tmp_path / "arm.toml"
    outcome = fitter("kinematics", learn, "--evaluate", evaluate, "--arm", guess, "--out", out)
    assert outcome.code == 0
    document = outcome.document
    assert set(document) == KEYS
    assert list(document["parameters"]) == NAMES
    assert all(set(p) == {"value", "std", "unit", "identifiable"} for p in document["parameters"].values())
    assert document["method"] == "ga" and document["generations"] == 500 and document["samples"] == 1350
    assert set(document["tip_error_mm"]) == {"learn", "evaluate"}
    assert all(set(error) == {"mean", "max"} for error in document["tip_error_mm"].values())
    assert document["angle_noise_deg"] == pytest.approx([0.0, 0.0], abs=0.05)
    assert document["angle_noise_source"] == "spectrum" and document["about"] == "rest"
    assert ["theta_offset1"] in [freedom["parameters"] for freedom in document["gauge"]]
    assert "not identified: d1" in outcome.said
    assert "identified only with the base as the arm file has it given: theta_offset1" in outcome.said
    low, high = document["ci95"]["a1"]
    assert low < document["parameters"]["a1"]["value"] < high and document["ci95"]["d1"] is None
    a1, d1 = document["parameters"]["a1"], document["parameters"]["d1"]
    assert a1["value"] == pytest.approx(0.25, abs=1e-6) and a1["identifiable"] and a1["unit"] == "m"
    assert d1 == {"value": 0.0, "std": None, "unit": "m", "identifiable": False}
    assert document["tip_error_mm"]["evaluate"]["max"] < 1e-2
    arm = load_arm(out)
    assert [joint.a_m for joint in arm.joints] == pytest.approx([0.25, 0.3], abs=1e-6)
    assert "tip displacement off by" in outcome.said


def test_without_evaluating_trials_that_part_is_null(fitter, files, guess, tmp_path):
    outcome = fitter("kinematics", files[0], "--arm", guess, "--out", tmp_path / "arm.toml")
    assert outcome.document["tip_error_mm"]["evaluate"] is None


def test_the_same_seed_gives_the_same_bytes_and_another_the_same_arm(fitter, files, guess, tmp_path):
    written = []
    for number, seed in enumerate((3, 3, 4)):
        out = tmp_path / f"{number}.toml"
        fitter("kinematics", files[0], "--arm", guess, "--seed", seed, "--out", out)
        written.append(out)
    assert written[0].read_bytes() == written[1].read_bytes()
    lengths = [[joint.a_m for joint in load_arm(path).joints] for path in (written[0], written[2])]
    assert np.allclose(lengths[0], lengths[1], atol=1e-6)


def test_restricted_conditions(fitter, files, guess, tmp_path):
    out = tmp_path / "arm.toml"
    restricted = ("--fix", "a2=0.31", "--bounds", "a1=0.1:0.4", "--free", "beta1")
    outcome = fitter("kinematics", files[0], "--arm", guess, "--out", out, *restricted)
    a2 = outcome.document["parameters"]["a2"]
    assert (a2["value"], a2["identifiable"]) == (0.31, False)
    assert load_arm(out).joints[1].a_m == 0.31


def test_a_recording_gives_both_sets_and_what_was_learnt_live(fitter, recording, calibration, guess, tmp_path):
    outcome = fitter("kinematics", recording, "--arm", guess, "--out", tmp_path / "arm.toml")
    assert outcome.code == 0
    assert outcome.document["parameters"]["a1"]["value"] == pytest.approx(0.25, abs=2e-3)
    assert outcome.document["parameters"]["a2"]["value"] == pytest.approx(0.3, abs=2e-3)
    assert outcome.document["tip_error_mm"]["evaluate"]["mean"] < 10.0
    assert "two motions can hardly tell" in outcome.said
    for name, length in (("a1", 0.25), ("a2", 0.3)):  # Student's with one degree of freedom
        low, high = outcome.document["ci95"][name]
        assert low < length < high and high - low > 20.0 * outcome.document["parameters"][name]["std"]
    live = calibration.kinematics().parameters
    for name in ("a1", "a2"):
        assert outcome.document["parameters"][name]["value"] == pytest.approx(live[name].value, abs=1e-4)
    in_folder = fitter("kinematics", recording.parent, "--arm", guess, "--out", tmp_path / "arm.toml")
    assert in_folder.document["samples"] == outcome.document["samples"]
    assert in_folder.document["tip_error_mm"] == outcome.document["tip_error_mm"]


def test_another_arm_stands_beside(fitter, files, guess, tmp_path):
    outcome = fitter("kinematics", files[0], "--arm", guess, "--compare", "dd-arm", "--out", tmp_path / "arm.toml")
    assert set(outcome.document) == KEYS | {"compared"}
    assert outcome.document["compared"]["dd-arm"]["a1"] == 0.25
    assert " 0.25" in outcome.said


def test_an_arm_without_a_tip_cannot_say_what_a_recording_measured(fitter, recording, short_run, tmp_path):
    save_arm(replace(short_run.arm, tip=None), tmp_path / "blunt.toml")
    outcome = fitter("kinematics", recording, "--arm", tmp_path / "blunt.toml", "--out", tmp_path / "arm.toml")
    assert outcome.code == 2
    assert outcome.errors == ["error: arm 'dd-arm' has no [tip], expected the sensor that measures it"]
    assert not (tmp_path / "arm.toml").exists()


@pytest.fixture(scope="module")
def one_by_one(short_run, tmp_path_factory):
    """Write samples as table 1 has them: angles at random, with 15 degrees of noise, and a tip with 30 mm."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (20_000, 2))
    tip = tip_position(short_run.arm, q) + 0.03 * rng.normal(size=(20_000, 3))
    noisy = q + np.deg2rad(15.0) * rng.normal(size=q.shape)
    path = tmp_path_factory.mktemp("table1") / "samples.npz"
    write_motion(path, {"t": 0.001 * np.arange(20_000), "q": noisy, "tip": tip})
    return path


def test_table_1_with_no_further_option(fitter, one_by_one, tmp_path):
    outcome = fitter("kinematics", one_by_one, "--arm", "dd-arm", "--out", tmp_path / "arm.toml")
    assert outcome.code == 0
    assert outcome.document["angle_noise_source"] == "moments" and outcome.document["about"] == "mean"
    assert outcome.document["angle_noise_deg"] == pytest.approx([15.0, 15.0], abs=1.0)
    assert outcome.document["parameters"]["a1"]["value"] == pytest.approx(0.25, abs=1.5e-3)
    assert outcome.document["parameters"]["a2"]["value"] == pytest.approx(0.3, abs=1.5e-3)
    assert "estimated together with the geometry" in outcome.said


def test_noise_that_is_given(fitter, one_by_one, tmp_path):
    def lengths(*options):
        outcome = fitter("kinematics", one_by_one, "--arm", "dd-arm", "--out", tmp_path / "arm.toml", *options)
        return [outcome.document["parameters"][name]["value"] for name in ("a1", "a2")], outcome

    plain, outcome = lengths("--angle-noise-deg", "0")
    assert plain[1] < 0.29 and outcome.document["angle_noise_deg"] == [0.0, 0.0]
    known, outcome = lengths("--angle-noise-deg", "15,15")
    assert known == pytest.approx([0.25, 0.3], abs=2e-3)
    assert outcome.document["angle_noise_source"] == "known"
    for wrong in ("-1", "1,2,3", "much"):
        arguments = ("--arm", "dd-arm", "--out", tmp_path / "arm.toml", f"--angle-noise-deg={wrong}")
        assert fitter("kinematics", one_by_one, *arguments).code == 2
