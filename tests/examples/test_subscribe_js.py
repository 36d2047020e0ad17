"""The subscriber in JavaScript, with its packages installed as package.json says."""

import shutil
import subprocess
from pathlib import Path

import pytest

from protocol.message import FRAMES, PLAY
from tests.examples.stream import EXAMPLES, check_printed, run_against_a_stream

INSTALL_S = 60.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        pytest.skip("node and npm are not there")
    place = tmp_path_factory.mktemp("js")
    for name in ("subscribe.js", "package.json"):
        shutil.copy(EXAMPLES / name, place)
    command = [npm, "install", "--no-audit", "--no-fund", "--prefer-offline", "--fetch-retries=0"]
    try:
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False, timeout=INSTALL_S)
    except subprocess.TimeoutExpired:
        pytest.skip(f"npm install takes longer than {INSTALL_S:g} s")
    if done.returncode != 0:
        pytest.skip(f"npm install failed: {done.stderr.strip().splitlines()[-1:]}")
    return place


@pytest.mark.parametrize("topic", [FRAMES, PLAY])
def test_it_prints_time_joints_and_tip(folder: Path, topic: str) -> None:
    lines = run_against_a_stream(["node", str(folder / "subscribe.js")], topic)
    assert len(lines) == 3
    for line in lines:
        check_printed(line)
