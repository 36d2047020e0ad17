"""What a running daemon says of itself, as a person and as a script see it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from daemon.__main__ import main

Limbd = Callable[..., Any]


def test_a_running_daemon_tells_how_it_is(limbd: Limbd, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    link, endpoint = tmp_path / "device", f"ipc://{tmp_path}/frames"
    device = limbd("virtual", "--link", str(link), "--rate-hz", "8000", "--json")
    device.announcement()
    daemon = limbd("run", "--port", str(link), "--arm", "dd-arm", "--endpoint", endpoint, "--json")
    daemon.announcement()
    assert main(["status", "--endpoint", endpoint, "--once", "--json"]) == 0
    health = json.loads(capfd.readouterr().out)
    assert health["connected"] and health["arm"] == "dd-arm"
    assert {alarm["name"] for alarm in health["alarms"]} <= {"behind", "disk"}  # a test machine may be busy
    assert main(["status", "--endpoint", endpoint, "--once"]) == 0
    said = capfd.readouterr().out
    assert "limbd, arm dd-arm" in said and "connected" in said and "samples" in said
    live = limbd("status", "--endpoint", endpoint, "--json")
    assert live.announcement()["connected"]
    assert live.stop() == 0
    assert daemon.stop() == 0
    assert device.stop() == 0


def test_no_daemon_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["status", "--endpoint", f"ipc://{tmp_path}/nobody", "--once"]) == 3
    assert "no daemon is heard" in capsys.readouterr().err
