"""`fitter kinematics --body`: what it takes, what it is about, and what it refuses."""

from argparse import Namespace
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Body
from benchmarks.simulated_people.person import person
from fitter.commands import limb_kinematics
from fitter.commands.limb_kinematics import body_of, method_lines, recordings_of
from limbcal.errors import ConfigError
from limbcal.note import Note
from tests.fitter.commands.test_limb import written_set, written_trc

RMS = {"rms": 1.25, "median": 1.0, "max": 4.0, "frames": 60}
ANSWER = {
    "samples": 60,
    "lengths_m": {"upper_arm": {"value": 0.3, "ci95": [0.295, 0.305]}},
    "centres": {"elbow": {"std_mm": 2.0, "apart_mm": None}, "shoulder": {"std_mm": 3.0, "apart_mm": 4.25}},
    "axes": {"flexion": {"std_deg": None, "apart_deg": 1.5}},
    "marker_rms_mm": {"learn": RMS, "evaluate": None},
    "explained": {"learn": 0.99, "evaluate": None},
}


@pytest.fixture
def trial(tmp_path):
    truth = person(n=60, seed=2)
    return written_trc(tmp_path / "move.trc", truth.recordings[0]), written_set(
        tmp_path / "s.toml", truth.marker_set
    )


@pytest.fixture
def calibrated(monkeypatch):
    """Put an answer into the calibration's mouth; return what it was asked."""
    asked = {}

    def calibrate(learn, evaluate, marker_set, limb, body, seed, progress, search):
        progress("fitting", 3)
        asked.update(learn=learn, evaluate=evaluate, limb=limb, body=body, seed=seed, search=search)
        notes = [Note("poor", "a marker slid")]
        written = lambda path, answer, notes: path.write_text(f"{len(notes)} notes")  # noqa: E731
        return SimpleNamespace(
            arm=load_arm("human-arm-right"), document=asked["answer"], notes=notes, write_page=written
        )

    asked["answer"] = ANSWER
    monkeypatch.setattr(limb_kinematics, "calibrated_limb", calibrate)
    return asked


def test_a_calibration_is_asked_written_and_said(fitter, tmp_path, trial, calibrated) -> None:
    out, page = tmp_path / "arm.toml", tmp_path / "page.html"
    options = ("--base", "thorax", "--up=-y", "--seed", 5, "--report", page)
    preset = ("--body", "human-arm-right", "--marker-set", trial[1])
    found = fitter("kinematics", trial[0], *preset, "--evaluate", trial[0], trial[0], *options, "--out", out)
    assert found.code == 0, found.errors
    assert calibrated["limb"] == ("human-arm-right", "thorax") and calibrated["seed"] == 5
    assert (len(calibrated["learn"]), len(calibrated["evaluate"])) == (1, 2)
    assert {one.up for one in (*calibrated["learn"], *calibrated["evaluate"])} == {"-y"}
    assert calibrated["body"] is None and calibrated["search"] is None
    assert [note["kind"] for note in found.document["notes"]] == ["poor", "no_masses"]
    assert load_arm(out).name == "human-arm-right" and page.read_text() == "2 notes"
    said = found.said
    for part in (
        "60 frames",
        "length upper_arm [mm]",
        "300",
        "± 5",
        "sd 2.0",
        "4.2",
        "sd ?",
        "1.5",
        f"report: {page}",
    ):
        assert part in said, part
    assert "learn: markers off by 1.2 mm rms, 1.0 median, 4 at the most, in 60 frames" in said
    assert "evaluate: markers" not in said


def test_a_search_is_as_large_as_asked(fitter, tmp_path, trial, calibrated) -> None:
    preset = (
        "--body",
        "human-arm-right",
        "--marker-set",
        trial[1],
        "--method",
        "ga",
        "--mass",
        70,
        "--height",
        1.8,
    )
    few = ("--sex", "m", "--population", 30, "--generations", 7)
    found = fitter("kinematics", trial[0], *preset, *few, "--out", tmp_path / "arm.toml")
    assert found.code == 0, found.errors
    assert (calibrated["search"].population, calibrated["search"].generations) == (30, 7)
    assert calibrated["body"] == Body("human-arm-right", 70.0, 1.8, "m")
    assert [note["kind"] for note in found.document["notes"]] == ["poor"]


@pytest.mark.parametrize(
    ("learn", "evaluate", "roles"),
    [(0.01, 0.02, "learning evaluating"), (0.99, 0.02, "evaluating"), (0.01, None, "learning")],
)
def test_what_explains_next_to_nothing_cannot_be_used(
    fitter, tmp_path, trial, calibrated, learn, evaluate, roles
) -> None:
    calibrated["answer"] = ANSWER | {"explained": {"learn": learn, "evaluate": evaluate}}
    preset = ("--body", "human-arm-right", "--marker-set", trial[1])
    found = fitter("kinematics", trial[0], *preset, "--out", tmp_path / "arm.toml")
    assert found.code == 4 and found.document["samples"] == 60
    for role in ("learning", "evaluating"):
        assert (f"{role} trials:" in found.said) == (role in roles.split())


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--body", "human-arm-right", "--population", 50), "--population is given"),
        (("--body", "human-arm-right", "--generations", 50), "--generations is given"),
        (("--body", "human-body", "--method", "ga"), "expected it with one limb"),
        (("--body", "human-leg-left", "--base", "scapula"), "--base is given with --body human-leg-left"),
        (("--body", "human-body", "--base", "thorax"), "expected it with a single arm"),
        (("--arm", "dd-arm", "--method", "bundle"), "expected it only with --body"),
        (("--arm", "dd-arm", "--up=+y", "--mass", 60), "--up is given, expected it only with --body"),
        (("--body", "human-arm-right", "--arm", "dd-arm"), "--arm is given, expected it only without --body"),
        (("--body", "human-arm-right", "--rate-hz", 50), "--rate-hz is given"),
        (("--body", "human-arm-right", "--probe", "acromion_right"), "expected LANDMARK=FILE"),
        (("--body", "human-arm-right", "--probe", "acromion_right="), "expected LANDMARK=FILE"),
    ],
)
def test_what_does_not_go_together_is_refused(fitter, tmp_path, trial, options, said) -> None:
    sets = ("--marker-set", trial[1]) if "--body" in options else ()
    learnt = fitter("kinematics", trial[0], *options, *sets, "--out", tmp_path / "arm.toml")
    assert learnt.code == 2 and said in " ".join(learnt.errors)


def given(mass=None, height=None, sex=None) -> Namespace:
    return Namespace(body="human-leg-left", mass=mass, height=height, sex=sex)


def test_a_person_is_known_by_mass_height_and_sex_together() -> None:
    assert body_of(given()) is None
    assert body_of(given(60.0, 1.7, "f")) == Body("human-leg-left", 60.0, 1.7, "f")
    with pytest.raises(ConfigError, match="^--height and --sex missing, expected --mass, --height and --sex"):
        body_of(given(mass=60.0))
    with pytest.raises(ConfigError, match="^--mass missing"):
        body_of(given(height=1.7, sex="f"))


def test_a_line_is_said_for_each_method_that_was_done() -> None:
    one = {"marker_rms_mm": 1.234, "apart_mm": 2.0, "centres_apart_mm": 3.0, "cost": -4.0, "cpu_s": 5.04}
    lines = method_lines({"compared": {"bundle": one, "ga": one | {"cost": 6.0}}})
    assert len(lines) == 2 and lines[0].startswith("bundle fit, from landmarks") and "cost +6.0" in lines[1]
    assert "1.23 mm rms; from the bundle fit markers 2.0, centres 3.0 mm, cost -4.0; 5.0 s" in lines[0]
    assert method_lines({}) == []


def test_of_a_recordings_notes_those_are_passed_on_that_matter_here(monkeypatch, tmp_path) -> None:
    recording = replace(person(n=2).recordings[0], path=str(tmp_path / "move.trc"))
    notes = [Note("swapped", "two were exchanged"), Note("gap", "one was away")]
    looked = [SimpleNamespace(recording=recording, notes=notes)]

    def read_markers(paths, done):
        assert paths == [tmp_path / "move.trc"]
        done(1)
        return looked

    monkeypatch.setattr(limb_kinematics, "read_markers", read_markers)
    recordings, found = recordings_of((tmp_path / "move.trc",))
    assert recordings == [recording]
    assert [(note.kind, note.source) for note in found] == [("swapped", "move.trc")]
    assert np.isfinite(recordings[0].positions).all()
