"""Under a service manager of the test's own: ready when it is, fed by the pipeline, stopped in order."""

import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.daemon.conftest import wait_until

Limbd = Callable[..., Any]


class Manager:
    """What systemd hears; it listens all the time, as systemd does."""

    def __init__(self, address: str) -> None:
        self.heard: list[dict[str, str]] = []
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(address)
        self._socket.settimeout(0.05)
        self._quiet, self._closing = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._attend, daemon=True)
        self._thread.start()

    def _attend(self) -> None:
        while not self._closing.is_set():
            try:
                text = self._socket.recv(4096).decode()
            except TimeoutError:
                self._quiet.set()
                continue
            self.heard.append(dict(line.split("=", 1) for line in text.splitlines()))

    def listen(self) -> None:
        """Return when all that was sent before has come."""
        self._quiet.clear()
        self._quiet.wait()

    def values(self, name: str) -> list[str]:
        self.listen()
        return [fields[name] for fields in self.heard if name in fields]

    def close(self) -> None:
        self._closing.set()
        self._thread.join()
        self._socket.close()


@pytest.fixture
def manager(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Manager]:
    made = Manager(str(tmp_path / "notify"))
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
    yield made
    made.close()


def test_it_is_ready_while_it_waits_and_streams(limbd: Limbd, manager: Manager, tmp_path: Path) -> None:
    link = tmp_path / "device"
    to = ("--arm", "dd-arm", "--method", "integrate", "--endpoint", f"ipc://{tmp_path}/f", "--json")
    daemon = limbd("run", "--wait", "--port", str(link), *to)
    wait_until(lambda: len(manager.values("WATCHDOG")) >= 3, "the waiting daemon was heard three times")
    assert manager.values("READY")
    assert manager.values("STATUS")[-1].startswith("waiting for a device: port ")
    device = limbd("virtual", "--link", str(link), "--rate-hz", "8000", "--json")
    device.announcement()
    pipeline = daemon.announcement()["processes"]["pipeline"]
    wait_until(lambda: f"streaming from {link}" in manager.values("STATUS"), "it said that it streams")
    fed = len(manager.values("WATCHDOG"))
    wait_until(lambda: len(manager.values("WATCHDOG")) >= fed + 2, "the pipeline fed the watchdog")
    # A pipeline that hangs is not covered up by anybody else.
    os.kill(pipeline, signal.SIGSTOP)
    manager.listen()
    fed = len(manager.values("WATCHDOG"))
    with pytest.raises(AssertionError, match="waited in vain"):
        wait_until(lambda: len(manager.values("WATCHDOG")) > fed + 1, "it was fed again", 3.0)
    os.kill(pipeline, signal.SIGCONT)
    wait_until(lambda: len(manager.values("WATCHDOG")) > fed + 1, "it was fed again")
    device.stop()
    wait_until(lambda: manager.values("STATUS")[-1].startswith("waiting for a device"), "it waits again")
    assert daemon.stop() == 0
    assert manager.values("STOPPING") == ["1"]


def test_a_silent_device_is_waited_for_where_one_is(limbd: Limbd, manager: Manager, tmp_path: Path) -> None:
    link = tmp_path / "device"
    master, slave = os.openpty()
    link.symlink_to(os.ttyname(slave))
    try:
        arguments = ("--port", str(link), "--arm", "dd-arm", "--endpoint", f"ipc://{tmp_path}/f", "--json")
        daemon = limbd("run", "--wait", *arguments)
        wait_until(lambda: bool(manager.values("WATCHDOG_USEC")), "it asked for patience")
        assert "the device sent nothing within 5 s" in manager.values("STATUS")[-1]
        said = "expected the device's INFO frame; waiting for it"
        wait_until(lambda: said in daemon.said, "it says that it waits")
        link.unlink()
        device = limbd("virtual", "--link", str(link), "--rate-hz", "8000", "--json")
        device.announcement()
        daemon.announcement()
        wait_until(lambda: f"streaming from {link}" in manager.values("STATUS"), "it streams")
        assert len(manager.values("WATCHDOG_USEC")) >= 2
        assert daemon.stop() == 0
        assert device.stop() == 0
    finally:
        os.close(master)
        os.close(slave)
