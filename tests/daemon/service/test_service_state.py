"""What systemd hears of a run, over a real notification socket."""

import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from daemon.service.service_state import ServiceState

Notified = Callable[..., list[str]]


@pytest.fixture
def notified(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Notified]:
    """Return what has a state hear something, and tells what the service manager hears of it."""
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
    monkeypatch.delenv("WATCHDOG_USEC", raising=False)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(tmp_path / "notify"))
        manager.setblocking(False)

        def hear(state: ServiceState, what: str, **fields: Any) -> list[str]:
            state.hear({"what": what, **fields})
            heard = []
            while True:
                try:
                    heard += manager.recv(4096).decode().splitlines()
                except BlockingIOError:
                    return heard

        yield hear


def test_the_watchdog_is_fed_by_who_has_work(notified: Notified) -> None:
    state = ServiceState("/dev/ttyX")
    assert notified(state, "trying") == ["WATCHDOG=1"]
    assert notified(state, "health") == ["WATCHDOG=1"]
    notified(state, "tracking")
    assert notified(state, "health") == ["WATCHDOG=1"]
    assert notified(state, "trying") == []  # the reader alone does not speak for a pipeline that hangs
    assert notified(state, "heard") == []


def test_it_is_ready_when_it_streams_or_waits(notified: Notified) -> None:
    state = ServiceState("/dev/ttyX")
    assert notified(state, "streaming") == ["READY=1", "WATCHDOG=1", "STATUS=streaming from /dev/ttyX"]
    waiting = ["READY=1", "WATCHDOG=1", "STATUS=waiting for a device: port /dev/ttyX does not exist"]
    sentence = {"sentence": "port /dev/ttyX does not exist"}
    assert notified(state, "waiting", **sentence) == [*waiting, "WATCHDOG_USEC=180000000"]
    notified(state, "tracking")
    assert notified(state, "waiting", **sentence) == waiting


def test_compiled_it_has_the_unit_s_time_again(notified: Notified, monkeypatch: pytest.MonkeyPatch) -> None:
    assert notified(ServiceState("p"), "tracking") == ["WATCHDOG_USEC=180000000"]
    monkeypatch.setenv("WATCHDOG_USEC", "15000000")
    assert notified(ServiceState("p"), "tracking") == ["WATCHDOG_USEC=15000000"]


def test_a_disk_that_fails_is_a_status(notified: Notified) -> None:
    assert notified(ServiceState("p"), "disk-failed", sentence="no room") == ["STATUS=no room"]
