"""Binding and connecting real sockets, and the sentences where that fails."""

import os
import socket as posix
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import zmq

from limbcal.errors import ConfigError, DeviceError
from protocol.binding import bind, connect
from tests.patience import PATIENCE_MS

Socket = zmq.Socket[bytes]


@pytest.fixture
def sockets() -> Iterator[Callable[[int], Socket]]:
    """Return what makes sockets that are closed in the end."""
    made: list[Socket] = []
    with zmq.Context() as context:

        def make(kind: int) -> Socket:
            made.append(context.socket(kind))
            made[-1].set(zmq.LINGER, 0)
            return made[-1]

        yield make
        for one in made:
            one.close()


@pytest.mark.parametrize("endpoint", ["tcp://127.0.0.1:*", "tcp://[::1]:*", "ipc://{folder}/here"])
def test_what_is_bound_is_heard_by_who_connects(
    sockets: Callable[[int], Socket], endpoint: str, tmp_path: Path
) -> None:
    if "::1" in endpoint and not Path("/proc/net/if_inet6").exists():
        pytest.skip("this machine has no IPv6")
    pull, push = sockets(zmq.PULL), sockets(zmq.PUSH)
    where = bind(pull, endpoint.format(folder=tmp_path))
    assert not where.endswith("*")
    connect(push, where)
    push.send(b"here")
    assert pull.poll(PATIENCE_MS) and pull.recv() == b"here"


def test_an_address_of_one_socket_is_not_another_s(sockets: Callable[[int], Socket], tmp_path: Path) -> None:
    for endpoint in ("tcp://127.0.0.1:*", f"ipc://{tmp_path}/here"):
        where = bind(sockets(zmq.PULL), endpoint)
        with pytest.raises(DeviceError, match="is already taken, expected a free one"):
            bind(sockets(zmq.PULL), where)


def test_a_socket_in_a_folder_is_its_owner_s_alone(sockets: Callable[[int], Socket], tmp_path: Path) -> None:
    before = os.umask(0o022)
    try:
        bind(sockets(zmq.PULL), f"ipc://{tmp_path}/here")
        assert stat.S_IMODE((tmp_path / "here").stat().st_mode) & 0o177 == 0
        assert os.umask(0o022) == 0o022  # what comes after has the rights it had
        bind(sockets(zmq.PULL), "tcp://127.0.0.1:*")
        assert os.umask(0o022) == 0o022
    finally:
        os.umask(before)


def test_one_that_nobody_listens_on_any_more_is_taken_over(
    sockets: Callable[[int], Socket], tmp_path: Path
) -> None:
    with posix.socket(posix.AF_UNIX) as gone:
        gone.bind(str(tmp_path / "here"))
    bind(sockets(zmq.PULL), f"ipc://{tmp_path}/here")


def test_a_file_that_is_no_socket_stays(sockets: Callable[[int], Socket], tmp_path: Path) -> None:
    (tmp_path / "data.csv").write_text("t,q1\n")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for name in ("data.csv", "link"):
        with pytest.raises(ConfigError, match="is a file that is no socket; expected a path that is free"):
            bind(sockets(zmq.PULL), f"ipc://{tmp_path}/{name}")
    assert (tmp_path / "data.csv").read_text() == "t,q1\n"


def test_a_folder_that_is_not_there_is_the_device_s_fault(
    sockets: Callable[[int], Socket], tmp_path: Path
) -> None:
    with pytest.raises(DeviceError, match="cannot be bound: No such file or directory"):
        bind(sockets(zmq.PULL), f"ipc://{tmp_path}/nowhere/here")
    (tmp_path / "file").write_text("")
    with pytest.raises(DeviceError, match="cannot be bound: Not a directory"):
        bind(sockets(zmq.PULL), f"ipc://{tmp_path}/file/here")


@pytest.mark.parametrize("endpoint", ["tcp://*:*", "tcp://0.0.0.0:*"])
def test_without_keys_no_other_machine_is_let_in(sockets: Callable[[int], Socket], endpoint: str) -> None:
    with pytest.raises(ConfigError, match="keys"):
        bind(sockets(zmq.PULL), endpoint)


def test_a_gate_is_put_before_what_others_reach(sockets: Callable[[int], Socket]) -> None:
    class Guard:
        guarded: list[Socket] = []

        def guard(self, socket: Socket) -> None:
            self.guarded.append(socket)

    gate, socket = Guard(), sockets(zmq.PULL)
    bind(socket, "tcp://*:*", gate)
    assert gate.guarded == [socket]


@pytest.mark.parametrize("endpoint", ["tcp://*:5770", "tcp://127.0.0.1:*", "tcp://127.0.0.1:0"])
def test_nobody_in_particular_cannot_be_connected_to(sockets: Callable[[int], Socket], endpoint: str) -> None:
    with pytest.raises(ConfigError):
        connect(sockets(zmq.PULL), endpoint)
