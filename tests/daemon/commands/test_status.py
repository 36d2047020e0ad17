"""What a running daemon says of itself, as a person and as a script see it."""

import io
import json
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import zmq
from rich.console import Console

from daemon.__main__ import main
from daemon.monitoring.status_view import _first, _next, view_of
from limbcal.errors import DeviceError
from protocol.message import HEALTH
from protocol.publisher import Publisher

Limbd = Callable[..., Any]


def test_a_running_daemon_tells_how_it_is(limbd: Limbd, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    link, endpoint = tmp_path / "device", f"ipc://{tmp_path}/frames"
    device = limbd("virtual", "--link", str(link), "--rate-hz", "8000", "--json")
    device.announcement()
    to = ("--arm", "dd-arm", "--method", "integrate", "--endpoint", endpoint, "--json")
    daemon = limbd("run", "--port", str(link), *to)
    daemon.announcement()
    assert main(["status", "--endpoint", endpoint, "--json"]) == 0
    health = json.loads(capfd.readouterr().out)
    assert health["connected"] and health["arm"] == "dd-arm"
    assert {alarm["name"] for alarm in health["alarms"]} <= {"behind", "disk"}  # a test machine may be busy
    assert health["readings"].keys() == health["still"].keys() == {"s1", "s2", "s3", "s4"}
    assert main(["status", "--endpoint", endpoint, "--once"]) == 0
    said = capfd.readouterr().out
    for word in ("limbd, arm dd-arm", "connected", "samples", "8000 Hz by its INFO", "joint", "reads s1"):
        assert word in said
    assert daemon.stop() == 0
    assert device.stop() == 0


def test_what_is_known_is_shown() -> None:
    health = {
        **dict.fromkeys(("uptime_s", "reconnects", "samples", "lost_samples", "crc_errors", "doubled", "late"), 0),
        "arm": "my-arm",
        "connected": True,
        "latency_ms": {"p50": None, "p99": None},
        "clock": {"ppm_std": 20.0, "error_ms": 0.3},
        "clock_ppm": -40_000.0,
        "rate_hz": 30720.04,
        "rate": {"claimed_hz": 32000.0, "in_use_hz": 30720.0, "std_ppm": 21.0},
        "readings": {"s1": [0.0, 3.0, 4.0], "s2": None},
        "still": {"s1": True, "s2": False},
        "q": [0.5, -0.25, None],
        "q_units": ["rad", "m", "rad"],
        "tracking": {"method": "filter", "wrong": False},
        "recording": None,
        "disk_free_bytes": None,
        "gaps": {"last": []},
        "alarms": [],
    }
    text = io.StringIO()
    Console(file=text, width=200).print(view_of("tcp://127.0.0.1:5770", health))
    said = text.getvalue()
    for words in (
        "30720.04 Hz ± 41 ppm; 32000 Hz by its INFO",
        "-40000.0 ± 39.2 ppm",
        "+0.5000 rad (+28.65°)",
        "-0.2500 m",
        "unknown",
        "|a| 5.000 at rest",
        "nothing came",
    ):
        assert words in said


def test_no_daemon_is_waited_for_and_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["status", "--endpoint", f"ipc://{tmp_path}/nobody", "--once", "--wait-s", "0.2"]) == 3
    assert "no daemon is heard" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--once"], ["--json"], []])
def test_a_health_that_is_no_daemons_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str]
) -> None:
    endpoint, over = f"ipc://{tmp_path}/playback", threading.Event()

    def play() -> None:
        with zmq.Context() as context, Publisher(context, endpoint, "dd-arm", "run") as publisher:
            while not over.wait(0.05):
                publisher.publish(HEALTH, {"uptime_s": 1.0, "last_seq": {}, "playing": True, "lateness_ms": None})

    player = threading.Thread(target=play)
    player.start()
    try:
        assert main(["status", "--endpoint", endpoint, *options]) == 2
    finally:
        over.set()
        player.join()
    said = capsys.readouterr()
    assert said.out == "" and said.err.splitlines() == [
        f"error: endpoint {endpoint}: who publishes there says nothing of connected, clock, tracking, "
        "expected the endpoint of `limbd run`"
    ]


class Scripted:
    """A subscriber that hears what the test scripted, and nothing before."""

    def __init__(self, *messages: tuple[str, dict[str, Any]] | None) -> None:
        self.messages = list(messages)
        self.timeouts_ms: list[int] = []

    def receive(self, timeout_ms: int) -> tuple[str, dict[str, Any]] | None:
        self.timeouts_ms.append(timeout_ms)
        return self.messages.pop(0)


def test_the_first_report_that_is_heard_is_waited_for(capsys: pytest.CaptureFixture[str]) -> None:
    report = {"samples": 7}
    assert _first(Scripted((HEALTH, report)), "ipc://here", 0.5) is report  # type: ignore[arg-type]
    late = Scripted(None, (HEALTH, report))
    assert _first(late, "ipc://here", 60.0) is report  # type: ignore[arg-type]
    assert "waiting for 60 s in all" in capsys.readouterr().err
    assert late.timeouts_ms[0] == 3000 and 0 < late.timeouts_ms[1] <= 60_000
    with pytest.raises(DeviceError, match="no daemon is heard on ipc://here within 0.5 s"):
        _first(Scripted(None), "ipc://here", 0.5)  # type: ignore[arg-type]


def test_a_daemon_that_falls_silent_is_said() -> None:
    assert _next(Scripted((HEALTH, {"samples": 8})), "ipc://here") == {"samples": 8}  # type: ignore[arg-type]
    with pytest.raises(DeviceError, match="the daemon on ipc://here is not heard any more"):
        _next(Scripted(None), "ipc://here")  # type: ignore[arg-type]
