"""`fitter diagnose` of recordings of markers: what it writes, and what it refuses."""

import json

import numpy as np
import pytest

from arm.arm_file import load_arm, save_arm
from benchmarks.simulated_people.person import person
from tests.fitter.commands.test_limb import written_trc
from tests.fitter.limb.test_tracking import with_markers
from tests.fitter.marker_diagnosis.test_marker_search import shifted


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("markers")
    truth = person(n=150, noise_m=1e-3, seed=4, trials=2)
    save_arm(with_markers(person(n=150, noise_m=0.0, seed=4)), folder / "arm.toml")
    moved = [shifted(truth, k, "upper_arm_right1", np.array([0.0, 0.02, -0.02])) for k in range(2)]
    return folder / "arm.toml", *(written_trc(folder / f"trial{k}.trc", one) for k, one in enumerate(moved))


def test_a_moved_marker_is_named_and_the_extended_arm_tracks_better(fitter, tmp_path, files):
    arm, learn, evaluate = files
    told = fitter("diagnose", learn, "--evaluate", evaluate, "--arm", arm, "--out", tmp_path / "d")
    assert told.code == 0, told.errors
    answer = told.document
    assert answer == json.loads((tmp_path / "d" / "diagnosis.json").read_text())
    assert answer["verdict"] == "named"
    (cause,) = answer["causes"]
    assert (cause["effect"], cause["markers"]) == ("marker_moved", ["upper_arm_right1"])
    assert "trials" not in cause and cause["takes_away"]["evaluate"] > 0.5
    assert answer["gain"]["ci95"][0] <= answer["gain"]["markers"] <= answer["gain"]["ci95"][1]
    assert (tmp_path / "d" / "report.html").read_text().count("upper_arm_right1") > 1
    assert load_arm(tmp_path / "d" / "extended.toml").effects[0].markers == ("upper_arm_right1",)
    rms = []
    for name in (arm, tmp_path / "d" / "extended.toml"):
        tracked = fitter("track", evaluate, "--arm", name, "--out", tmp_path / "motion.csv")
        rms.append(tracked.document["marker_rms_mm"]["per_marker"]["upper_arm_right1"])
    assert rms[1] < 0.5 * rms[0]
    assert rms[1] == pytest.approx(answer["after"]["marker_rms_mm"]["per_marker"]["upper_arm_right1"], rel=1e-6)


def test_what_is_for_joint_motion_is_refused_in_one_go(fitter, tmp_path, files):
    arm, learn, _ = files
    told = fitter("diagnose", learn, "--no-torque", "--deny", "coulomb", "--arm", arm, "--out", tmp_path / "d")
    assert told.code == 2
    said = " ".join(told.errors)
    assert all(name in said for name in ("--no-torque", "--deny", "--evaluate is missing"))
