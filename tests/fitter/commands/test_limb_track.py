"""`fitter track` of markers: one file of all trials, on the recordings' own clocks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import save_arm
from benchmarks.simulated_people.person import person, with_gaps, with_markers
from fitter.commands.limb_track import has_markers
from limbcal.errors import ConfigError
from tests.fitter.commands.test_limb import written_trc


@pytest.fixture(scope="module")
def truth():
    return person(n=60, seed=3, trials=2)


@pytest.fixture
def arm_file(truth, tmp_path):
    save_arm(with_markers(truth), tmp_path / "arm.toml")
    return tmp_path / "arm.toml"


def test_files_are_of_one_kind() -> None:
    assert has_markers([Path("a.c3d"), Path("b.TRC")])
    assert not has_markers([Path("a.csv"), Path("trc")])
    with pytest.raises(ConfigError, match=r"b\.csv: it is no recording of markers but others are"):
        has_markers([Path("a.trc"), Path("b.csv"), Path("c.csv")])


def test_trials_of_one_name_are_told_apart_and_follow_the_truth(fitter, tmp_path, truth, arm_file) -> None:
    files = []
    for folder, recording in zip(("a", "b"), truth.recordings, strict=True):
        (tmp_path / folder).mkdir()
        seen = with_gaps(replace(recording, t0_s=3.0), np.random.default_rng(0), 0.05)
        files.append(written_trc(tmp_path / folder / "move.trc", seen))
    files.append(written_trc(tmp_path / "other.trc", truth.recordings[0]))
    out = tmp_path / "motion.npz"
    exported = tmp_path / "angles.mot"
    tracked = fitter("track", *files, "--arm", arm_file, "--out", out, "--export", exported)
    assert tracked.code == 0, tracked.errors
    found, document = np.load(out), tracked.document
    assert list(dict.fromkeys(found["trial"].tolist())) == ["1.move", "2.move", "other"]
    q = np.column_stack([found[f"q{k + 1}"] for k in range(7)])
    np.testing.assert_allclose(q, np.vstack([*truth.q, truth.q[0]]), rtol=0, atol=0.1)
    np.testing.assert_allclose(found["t"][:60], 3.0 + np.arange(60) / 50.0)
    assert (found["q_std1"] > 0.0).all() and found["base_x"].shape == (180,)
    assert (document["method"], document["frames"], document["trials"]) == ("markers", 180, 3)
    rms = document["marker_rms_mm"]
    assert 0.3 < rms["median"] < rms["rms"] < 2.0 and set(rms["per_marker"]) == set(truth.recordings[0].names)
    assert f"180 frames in 3 trial(s), markers off by {rms['rms']:.1f} mm rms" in tracked.said
    assert document["exported"] == [str(tmp_path / f"angles_{name}.mot") for name in ("1.move", "2.move", "other")]


def test_a_single_trial_has_no_label(fitter, tmp_path, truth, arm_file) -> None:
    trial, out = written_trc(tmp_path / "move.trc", truth.recordings[0]), tmp_path / "m.npz"
    assert fitter("track", trial, "--arm", arm_file, "--out", out).document["trials"] == 1
    assert "trial" not in np.load(out)


@pytest.mark.parametrize(
    "option", [("--zero", "each-rest"), ("--initial-q", "0,0"), ("--columns", "q=a"), ("--rate-hz", "50")]
)
def test_options_of_accelerations_are_refused(fitter, tmp_path, arm_file, option) -> None:
    wrong = fitter("track", tmp_path / "move.trc", "--arm", arm_file, "--out", tmp_path / "m.csv", *option)
    assert wrong.code == 2
    assert f"{option[0]} is given, expected it only with accelerations" in wrong.said
