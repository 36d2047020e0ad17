"""`limbplay export` as it is typed."""

import json
import signal
import subprocess
import sys
import threading
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pyarrow.csv
import pytest

from playback.__main__ import main
from playback.commands import export
from tests.playback.export.test_foxglove import read
from tests.playback.export.test_gltf import Viewer


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".csv", ".mcap", ".mp4", ".gif"])
def test_it_writes_what_the_suffix_says(
    suffix: str, motion_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "films" / f"motion{suffix}"
    size = ["--size", "320x180"] if suffix in (".mp4", ".gif") else []
    options = ["--trial", "2", "--speed", "2", "--rate-hz", "20", "--arm", "dd-arm", "--json"]
    assert main(["export", str(motion_file), "--out", str(out), *options, *size]) == 0
    printed = capsys.readouterr()
    answer = json.loads(printed.out)
    assert (answer["format"], answer["frames"], answer["rate_hz"]) == (suffix[1:], 11, 20.0)
    assert (answer["duration_s"], answer["trial"], answer["arm"], answer["twin"]) == (0.5, 2, "dd-arm", None)
    assert answer["bytes"] == out.stat().st_size
    assert "11 frames of waves.npz, trial 2" in printed.err
    assert [found.name for found in out.parent.iterdir()] == [out.name]


def test_a_twin_goes_with_it(motion_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["export", str(motion_file), "--arm", "dd-arm", "--twin", str(motion_file), "--json"]
    outs = [tmp_path / name for name in ("pair.glb", "pair.csv", "pair.mcap")]
    for out in outs:
        assert main([*arguments, "--out", str(out)]) == 0
        assert json.loads(capsys.readouterr().out)["twin"] == "dd-arm"
    assert "joint 2 (twin)" in Viewer(outs[0]).number
    columns = pyarrow.csv.read_csv(outs[1])
    assert columns.column("twin_q1") == columns.column("q1")
    assert read(outs[2])["/twin/joints"]


def test_a_recording_is_exported_with_its_own_arm(recording: Path, tmp_path: Path) -> None:
    out = tmp_path / "day.glb"
    assert main(["export", str(recording), "--out", str(out), "--trial", "2", "--rate-hz", "10"]) == 0
    assert "dd-arm" in Viewer(out).number


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--out", "a.avi"], "a.avi: the suffix is '.avi', expected one of .glb, .gltf, .csv, .mp4, .gif, .mcap"),
        (["--out", "a.glb", "--trial", "9"], "there is no trial 9, expected one of 1, 2, 3"),
        ([], "--out missing"),
    ],
)
def test_mistakes_are_told(
    arguments: list[str], said: str, motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(motion_file), "--arm", "dd-arm", *arguments]) == 2
    printed = capsys.readouterr()
    assert said in printed.err
    assert printed.out == ""


def test_what_is_not_installed_is_named(
    motion_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(export, "import_module", missing)
    assert main(["export", str(motion_file), "--out", str(tmp_path / "a.mp4")]) == 2
    printed = capsys.readouterr().err
    assert (
        'needs the package imageio-ffmpeg, which is not installed; pip install "limbcal[video]" adds it' in printed
    )


def test_a_stop_leaves_no_file_and_no_encoder(motion_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "long.mp4"
    command = [sys.executable, "-m", "playback", "export", str(motion_file), "--arm", "dd-arm", "--trial", "3"]
    command += ["--out", str(out), "--rate-hz", "1000", "--size", "320x180"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            while not list(tmp_path.iterdir()):  # until the encoder has begun its file
                assert process.poll() is None
                threading.Event().wait(0.01)
            process.send_signal(signal.SIGTERM)
            words = process.communicate()[1]
        finally:
            process.kill()
    assert process.returncode == 0 and "stopped" in words
    assert list(tmp_path.iterdir()) == []


def test_the_film_has_the_length_of_the_motion(motion_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "film.mp4"
    options = ["--trial", "3", "--rate-hz", "10", "--size", "320x180", "--arm", "dd-arm"]
    assert main(["export", str(motion_file), "--out", str(out), *options]) == 0
    assert imageio_ffmpeg.count_frames_and_secs(str(out)) == (16, pytest.approx(1.6, abs=0.02))


def test_time_without_end_is_a_question_and_a_leap_a_trial_of_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    t = 0.001 * np.arange(700)
    path, out = tmp_path / "motion.npz", tmp_path / "motion.csv"
    np.savez(path, t=1e6 * t, q1=t, q2=t)
    arguments = ["export", str(path), "--arm", "dd-arm", "--out", str(out), "--json"]
    assert main(arguments) == 2
    assert "stamps lie 1000 apart, expected seconds" in capsys.readouterr().err
    assert main([*arguments, "--columns", "t=t:us"]) == 0
    assert json.loads(capsys.readouterr().out)["duration_s"] < 0.7
    np.savez(path, t=np.where(t < 0.4, t, t + 86400.0), q1=t, q2=t)
    assert main([*arguments, "--trial", "2"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["duration_s"] < 0.3 and [note["kind"] for note in answer["notes"]] == ["gap"]
