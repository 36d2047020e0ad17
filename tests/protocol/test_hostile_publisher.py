"""A publisher that means harm: what it sends and nobody can read is bounded, and an honest one is heard again."""

import itertools
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import closing

import psutil
import pytest
import zmq

import protocol.subscriber
from protocol.inbox import Inbox
from protocol.message import FRAMES
from protocol.parts import MESSAGE_BYTES
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber
from tests.hostile import frame, greet, part
from tests.patience import PATIENCE_MS, PATIENCE_S

#: Less than usual, so that the tests need not send so much [bytes].
LIMIT = 4 << 20
#: More than a subscriber may take in [bytes], and what its process may grow by: buffers, a few looks late.
MOST_SENT, MOST_GROWN = 400_000_000, 120e6

TOPIC = part(FRAMES.encode())
PILES: dict[str, Callable[[], Iterator[bytes]]] = {
    "parts of 100 bytes": lambda: itertools.repeat(part(bytes(100))),
    "parts of a megabyte": lambda: itertools.repeat(part(bytes(1_000_000))),
    "a topic, and then parts": lambda: itertools.chain(
        [part(FRAMES.encode())], itertools.repeat(part(bytes(5000)))
    ),
    "messages that nobody reads": lambda: itertools.repeat(TOPIC + frame(bytes(200_000))),
    "a part that is too big": lambda: itertools.chain(
        [part(FRAMES.encode()), _begun(MESSAGE_BYTES + 1)], _bytes()
    ),
    "a part of all that there is": lambda: itertools.chain([TOPIC, _begun(1 << 62)], _bytes()),
}


def _begun(size: int) -> bytes:
    """Return the beginning of a long part."""
    return b"\x02" + size.to_bytes(8, "big")


def _bytes() -> Iterator[bytes]:
    return itertools.repeat(bytes(65536))


@pytest.fixture(autouse=True)
def low_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol.subscriber, "UNREAD_LIMIT", LIMIT)


@pytest.fixture
def context() -> Iterator["zmq.Context[zmq.Socket[bytes]]"]:
    with zmq.Context() as opened:
        yield opened


@pytest.fixture
def lair() -> Iterator[socket.socket]:
    with closing(socket.create_server(("127.0.0.1", 0))) as opened:
        opened.settimeout(PATIENCE_S)
        yield opened


def endpoint_of(lair: socket.socket) -> str:
    return f"tcp://127.0.0.1:{lair.getsockname()[1]}"


def sent_until_left(lair: socket.socket, pieces: Iterator[bytes], receive: Callable[[], object]) -> int:
    """Be a publisher that sends until its subscriber leaves; return how many bytes it took."""
    line, _ = lair.accept()
    with line:
        line.settimeout(PATIENCE_S)
        greet(line, b"PUB")
        line.settimeout(0.05)
        sent, gulp = 0, b""
        while sent < MOST_SENT:
            receive()
            while len(gulp) < 65536:
                gulp += next(pieces)
            try:
                taken = line.send(gulp)
            except TimeoutError:
                continue
            except OSError:
                return sent
            gulp = gulp[taken:]
            sent += taken
    return sent


@pytest.mark.parametrize("pile", PILES)
@pytest.mark.parametrize("watched", [False, True], ids=["who receives", "who is busy"])
def test_who_sends_what_nobody_can_read_is_left(
    context: "zmq.Context[zmq.Socket[bytes]]", lair: socket.socket, pile: str, watched: bool
) -> None:
    with Subscriber(context, endpoint_of(lair), [FRAMES], watched=watched) as subscriber:
        before = psutil.Process().memory_info().rss

        def receive() -> None:
            if not watched and pile != "messages that nobody reads":
                assert subscriber.receive(0) is None
            elif not watched:
                subscriber._peers.look()

        sent = sent_until_left(lair, PILES[pile](), receive)
        assert sent < MOST_SENT
        assert psutil.Process().memory_info().rss - before < MOST_GROWN


def test_an_honest_one_in_its_place_is_heard(
    context: "zmq.Context[zmq.Socket[bytes]]", lair: socket.socket
) -> None:
    endpoint = endpoint_of(lair)
    with Subscriber(context, endpoint, [FRAMES], watched=True) as subscriber:
        assert sent_until_left(lair, PILES["a topic, and then parts"](), lambda: None) < MOST_SENT
        assert subscriber.refused >= 1
        lair.close()
        with Publisher(context, endpoint, "arm", "run") as publisher:
            while (message := subscriber.receive(10)) is None:
                publisher.publish(FRAMES, {"x": 1})
        assert message[1]["x"] == 1 and not subscriber.missed


def test_an_inbox_leaves_one_too(context: "zmq.Context[zmq.Socket[bytes]]", lair: socket.socket) -> None:
    with Subscriber(context, endpoint_of(lair), [FRAMES], watched=True) as subscriber, Inbox(subscriber) as inbox:
        assert sent_until_left(lair, PILES["parts of a megabyte"](), lambda: None) < MOST_SENT
        assert inbox.receive(0) is None


@pytest.mark.parametrize("waits", [0.0, 0.005, 0.05])
def test_a_context_that_ends_first_ends_the_watch_too(waits: float) -> None:
    context = zmq.Context()
    subscriber = Subscriber(context, "tcp://127.0.0.1:1", [FRAMES], watched=True)
    threading.Event().wait(waits)
    context.destroy(linger=0)
    subscriber.close()
    assert not [thread for thread in threading.enumerate() if thread.name == "peers"]


def test_what_is_read_counts_for_nothing(context: "zmq.Context[zmq.Socket[bytes]]") -> None:
    with (
        Publisher(context, "tcp://127.0.0.1:*", "arm", "run") as publisher,
        Subscriber(context, publisher.endpoint, [FRAMES], watched=True) as subscriber,
    ):
        while subscriber.receive(5) is None:
            publisher.publish(FRAMES, {})
        while subscriber.receive(20) is not None:
            pass
        for _ in range(4 * LIMIT // 1_000_000):
            publisher.publish(FRAMES, {"x": bytes(1_000_000)})
            assert subscriber.receive(PATIENCE_MS) is not None
        assert subscriber.refused == 0 and not subscriber.missed
