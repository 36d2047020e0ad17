"""A service manager is notified; one that is gone or reads nothing stops nobody."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from limbcal import notify as module
from limbcal.notify import notify


@pytest.fixture
def manager(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as made:
        made.bind(str(tmp_path / "notify"))
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        yield made


def test_what_is_said_arrives_each_field_in_a_line(manager: socket.socket) -> None:
    assert notify(READY=1, STATUS="two\nlines")
    assert manager.recv(1000) == b"READY=1\nSTATUS=two lines"


def test_nobody_to_tell(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("NOTIFY_SOCKET", raising=False)
    assert not notify(READY=1)
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "gone"))
    assert not notify(READY=1)


@pytest.mark.usefixtures("manager")
def test_a_manager_that_reads_nothing_holds_nobody_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_PATIENCE_S", 0.01)
    while notify(WATCHDOG=1):  # until no more finds room
        pass
    assert not notify(WATCHDOG=1)


def test_a_name_that_begins_with_an_at_is_no_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    name = f"limbcal-test-{tmp_path}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as made:
        made.bind(f"\0{name}")
        monkeypatch.setenv("NOTIFY_SOCKET", f"@{name}")
        assert notify(STOPPING=1)
        assert made.recv(1000) == b"STOPPING=1"
