"""Replies on a real socket, to clients that take them when they like."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
import zmq

from playback.control_socket import KEPT_LIMIT, ControlSocket
from tests.patience import PATIENCE_MS

N_REQUEST = 5000


@pytest.fixture
def control(context: zmq.Context[zmq.Socket[bytes]], tmp_path: Path) -> Iterator[ControlSocket]:
    """Answers with the request and as many bytes as it names."""

    def answer(parts: Sequence[bytes]) -> bytes:
        return parts[-1] + bytes(int(parts[-1].split()[1]))

    control = ControlSocket(context, f"ipc://{tmp_path}/control", answer)
    yield control
    control.close()


@pytest.fixture
def lazy(control: ControlSocket, context: zmq.Context[zmq.Socket[bytes]]) -> Iterator[zmq.Socket[bytes]]:
    """Ask without limit, and take in no reply that is not read."""
    with dealer(control, context) as socket:
        yield socket


def dealer(control: ControlSocket, context: zmq.Context[zmq.Socket[bytes]]) -> zmq.Socket[bytes]:
    socket = context.socket(zmq.DEALER)
    socket.linger = 0
    socket.sndhwm = 0
    socket.rcvhwm = 1
    socket.connect(control.endpoint)
    return socket


def take(control: ControlSocket, n: int) -> None:
    """Take in a number of requests."""
    for _ in range(n):
        assert control.socket.poll(PATIENCE_MS)
        control.serve()


def receive(control: ControlSocket, socket: zmq.Socket[bytes]) -> bytes:
    """Return the next reply, while the other side serves on."""
    for _ in range(PATIENCE_MS):
        control.serve()
        if socket.poll(1):
            return socket.recv()
    pytest.fail("no reply came")


def test_a_client_that_reads_late_gets_every_reply_in_order(control, lazy, context) -> None:
    for k in range(N_REQUEST):
        lazy.send(b"%d 700" % k)
    take(control, N_REQUEST)
    assert control.keeps
    with dealer(control, context) as other:  # meanwhile others are answered
        other.send(b"other 0")
        assert receive(control, other) == b"other 0"
    replies = [receive(control, lazy) for _ in range(N_REQUEST)]
    assert replies == [b"%d 700" % k + bytes(700) for k in range(N_REQUEST)]
    assert not control.keeps
    assert control.unheard == 0


def test_one_that_never_reads_is_no_longer_heard_until_it_has(control, lazy) -> None:
    n_request, size = 400, KEPT_LIMIT // 50
    for k in range(n_request):
        lazy.send(b"%d %d" % (k, size))
    take(control, n_request)
    assert n_request - 300 < control.unheard < n_request - 50
    answered = [receive(control, lazy)[: len(b"0 ")] for _ in range(n_request - control.unheard)]
    assert answered[:10] == [b"%d " % k for k in range(10)]
    assert not control.keeps
    lazy.send(b"again 0")
    assert receive(control, lazy) == b"again 0"


def test_one_that_reads_as_it_asks_is_heard_whatever_it_was_sent(control, lazy) -> None:
    n_asked = n_kept = 0
    while n_kept < 20:  # the line takes some, and then they are kept
        lazy.send(b"%d %d" % (n_asked, KEPT_LIMIT // 400))
        take(control, 1)
        n_asked, n_kept = n_asked + 1, n_kept + control.keeps
    for k in range(600):  # more than may be kept, by far more than the line takes now and then
        lazy.send(b"%d %d" % (n_asked + k, KEPT_LIMIT // 400))
        take(control, 1)
        assert receive(control, lazy).startswith(b"%d " % k)
    assert control.unheard == 0


def test_what_was_kept_for_a_client_that_left_is_forgotten(control, context) -> None:
    with dealer(control, context) as leaving:
        for k in range(N_REQUEST):
            leaving.send(b"%d 700" % k)
        take(control, N_REQUEST)
        assert control.keeps
    for _ in range(PATIENCE_MS):
        if not control.keeps:
            break
        control.serve()
        control.socket.poll(1)
    assert not control.keeps


@pytest.mark.parametrize(
    ("sent", "asked", "replied"),
    [
        ([b"", b"ask"], [b"ask"], [b"", b"reply"]),  # as REQ does
        ([b"ask"], [b"ask"], [b"reply"]),
        ([b""], [b""], [b"reply"]),
        ([b"one", b"two"], [b"one", b"two"], [b"reply"]),
        ([b"", b"one", b"two"], [b"one", b"two"], [b"", b"reply"]),
    ],
)
def test_a_reply_goes_the_way_back(
    context: zmq.Context[zmq.Socket[bytes]],
    tmp_path: Path,
    sent: list[bytes],
    asked: list[bytes],
    replied: list[bytes],
) -> None:
    heard: list[list[bytes]] = []

    def answer(parts: Sequence[bytes]) -> bytes:
        heard.append([*parts])
        return b"reply"

    control = ControlSocket(context, f"ipc://{tmp_path}/control", answer)
    try:
        with dealer(control, context) as socket:
            control.serve()  # nothing has come
            socket.send_multipart(sent)
            take(control, 1)
            assert socket.poll(PATIENCE_MS)
            assert socket.recv_multipart() == replied
        assert heard == [asked] and not control.keeps
    finally:
        control.close()
