"""What a running daemon says of itself, as a person and as a script see it."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import zmq

from daemon.__main__ import main
from protocol.message import HEALTH
from protocol.publisher import Publisher

Limbd = Callable[..., Any]


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
