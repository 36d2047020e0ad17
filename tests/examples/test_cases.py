"""One of the cases on measured data, on a part of it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DATA = Path(os.environ.get("LIMBCAL_DATA", ROOT / ".." / "shared" / "data"))
PATIENCE_S = 240.0


def run(module: str, *options: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", f"examples.cases.{module}", "--json", *options]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S, check=False)


def test_the_level_frictionless_arm_finds_gravity_and_friction(tmp_path):
    if not (DATA / "dfki_double_pendulum").is_dir():
        pytest.skip(f"no measured data in {DATA / 'dfki_double_pendulum'}; LIMBCAL_DATA can name another folder")
    part = ["--every", "2", "--rate-hz", "60", "--most", "3"]
    done = run("dfki_double_pendulum", *part, "--data", str(DATA), "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["causes"][0]["effect"] == "gravity_tilt"
    assert len(told["causes"]) == 3
    swing_up = [both["20230629-154220"][2] for both in told["torque_rms_N_m"].values()]
    assert swing_up[3] < 0.5 * swing_up[0]
    page = (tmp_path / "dfki-double-pendulum.md").read_text(encoding="utf-8")
    assert "gravity_tilt" in page and f"{swing_up[3]:.3f}" in page
    assert (tmp_path / "dfki-double-pendulum.png").read_bytes().startswith(b"\x89PNG")


def test_missing_recordings_are_one_sentence(tmp_path):
    done = run("multiarm_pendulum", "--data", str(tmp_path), "--out", str(tmp_path))
    assert done.returncode == 2
    assert "there is no such file" in done.stderr and "Traceback" not in done.stderr
