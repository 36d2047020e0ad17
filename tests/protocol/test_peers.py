"""Subscribers and clients that send too much are shown out, and nobody else notices."""

import itertools
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest
import zmq

from protocol.curve import gate_of, load_client_key, new_client
from protocol.message import HEALTH
from protocol.parts import MOST_PARTS, receive_parts
from protocol.peers import MOST_CONNECTIONS, Peers
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber
from protocol.subscriptions import FRAME_LIMIT, MOST_TOPICS, TOPIC_LIMIT
from tests.hostile import (
    frame,
    greet,
    handshake,
    many_topics,
    messages,
    noise,
    one_topic_again_and_again,
    open_line,
    parts_without_end,
    send_until_shown_out,
)
from tests.patience import PATIENCE_MS, PATIENCE_S

#: Between two looks at what is waited for [s]: one that never pauses takes the processor from what it waits for.
PAUSE_S = 0.001
#: More than any limit [bytes], and what the process may grow by meanwhile.
MOST_SENT, MOST_GROWN = 200_000_000, 20e6
#: What ZeroMQ keeps of a part (`zmq_msg_t`, 64 bytes, in chunks), and what it came with on the wire [bytes].
KEPT, HEADER = 72, 2

PILES: dict[str, Callable[[], Iterator[bytes]]] = {
    "short topics": lambda: many_topics(8),
    "long topics": lambda: many_topics(60),
    "topics that are too long": lambda: many_topics(400),
    "one topic again and again": one_topic_again_and_again,
    "parts of a byte": lambda: parts_without_end(1),
    "parts of 100 bytes": lambda: parts_without_end(100),
    "parts that are just not too big": lambda: parts_without_end(FRAME_LIMIT),
    "a part that is too big": lambda: parts_without_end(FRAME_LIMIT + 1),
    "no subscriptions": lambda: messages(200),
    "noise": noise,
}


@pytest.fixture
def context() -> Iterator["zmq.Context[zmq.Socket[bytes]]"]:
    with zmq.Context() as opened:
        yield opened


@pytest.fixture
def publisher(context: "zmq.Context[zmq.Socket[bytes]]") -> Iterator[Publisher]:
    with Publisher(context, "tcp://127.0.0.1:*", "arm", "run", watched=True) as opened:
        yield opened


def port_of(publisher: Publisher) -> int:
    return int(publisher.endpoint.rpartition(":")[2])


def attend_until(publisher: Publisher, done: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < end_s
        publisher.publish(HEALTH, {})
        time.sleep(PAUSE_S)


def hears(subscriber: Subscriber, publisher: Publisher, topic: str) -> bool:
    publisher.publish(topic, {})
    message = subscriber.receive(0)
    return message is not None and message[0] == topic


def read_on(subscriber: Subscriber) -> bool:
    """Read what has come; return whether anything is missing."""
    while subscriber.receive(0) is not None:
        pass
    return bool(subscriber.missed)


def read_newest(subscriber: Subscriber, publisher: Publisher) -> None:
    """Publish and read until it has come: whoever publishes faster than others read is no measure of a crowd."""
    publisher.publish(HEALTH, {})
    message = subscriber.receive(PATIENCE_MS)
    while message is not None and message[1]["seq"] < publisher.last_seq[HEALTH]:
        message = subscriber.receive(PATIENCE_MS)
    assert message is not None


@pytest.mark.parametrize("pile", PILES)
def test_who_sends_too_much_is_shown_out_and_nobody_else(
    publisher: Publisher, context: "zmq.Context[zmq.Socket[bytes]]", pile: str
) -> None:
    with Subscriber(context, publisher.endpoint, [HEALTH]) as honest:
        attend_until(publisher, lambda: honest.receive(0) is not None)
        before = psutil.Process().memory_info().rss
        with open_line(port_of(publisher)) as line:
            greet(line, b"SUB")
            line.settimeout(0.05)
            pieces, sent, pending = PILES[pile](), 0, b""
            while sent < MOST_SENT:
                read_newest(honest, publisher)
                pending = pending or b"".join(itertools.islice(pieces, 1000))
                try:
                    n_sent = line.send(pending)
                except TimeoutError:
                    continue
                except OSError:
                    break
                pending, sent = pending[n_sent:], sent + n_sent
            assert sent < MOST_SENT
        assert psutil.Process().memory_info().rss - before < MOST_GROWN
        read_newest(honest, publisher)
        assert not honest.missed and not honest.restarts


def test_as_many_topics_as_there_may_be(publisher: Publisher, context: "zmq.Context[zmq.Socket[bytes]]") -> None:
    topics = [f"{k:0{TOPIC_LIMIT}d}" for k in range(MOST_TOPICS)]
    where = publisher.endpoint
    with Subscriber(context, where, topics) as one, Subscriber(context, where, topics) as two:
        for subscriber, topic in itertools.product((one, two), (topics[0], topics[-1])):
            attend_until(publisher, lambda: hears(subscriber, publisher, topic))  # noqa: B023 - called at once
        assert publisher.refused == 0


@pytest.mark.parametrize(
    "topics", [["x" * (TOPIC_LIMIT + 1)], [str(k) for k in range(MOST_TOPICS + 1)]], ids=["too long", "too many"]
)
def test_over_a_unix_socket_one_more_is_too_much_too(
    context: "zmq.Context[zmq.Socket[bytes]]", tmp_path: Path, topics: list[str]
) -> None:
    with (
        Publisher(context, f"ipc://{tmp_path}/frames", "arm", "run") as publisher,
        Subscriber(context, publisher.endpoint, topics),
    ):
        attend_until(publisher, lambda: publisher.refused > 0)


def test_topics_that_were_given_up_count_no_more(
    publisher: Publisher, context: "zmq.Context[zmq.Socket[bytes]]"
) -> None:
    with Subscriber(context, publisher.endpoint, [HEALTH]) as subscriber:
        for k in range(3 * MOST_TOPICS):
            subscriber.socket.subscribe(f"limb/{k}")
            subscriber.socket.unsubscribe(f"limb/{k}")
        attend_until(publisher, lambda: subscriber.receive(0) is not None)
        subscriber.socket.subscribe("last")
        attend_until(publisher, lambda: hears(subscriber, publisher, "last"))
        assert publisher.refused == 0


def test_topics_of_friends_are_bounded_too(context: "zmq.Context[zmq.Socket[bytes]]", tmp_path: Path) -> None:
    key = load_client_key(new_client(tmp_path, "friend", tmp_path / "friend.limbkey"))
    with gate_of(context, tmp_path) as gate, Publisher(context, "tcp://127.0.0.1:*", "a", "r", gate) as publisher:
        with Subscriber(context, publisher.endpoint, [HEALTH], key) as honest:
            attend_until(publisher, lambda: honest.receive(0) is not None)
            with Subscriber(context, publisher.endpoint, [str(k) for k in range(MOST_TOPICS + 1)], key):
                attend_until(publisher, lambda: read_on(honest) or publisher.refused > 0)
            read_on(honest)
            assert not honest.missed


def test_those_who_say_nothing_make_room(publisher: Publisher, context: "zmq.Context[zmq.Socket[bytes]]") -> None:
    lines = [open_line(port_of(publisher)) for _ in range(MOST_CONNECTIONS + 10)]
    try:
        with Subscriber(context, publisher.endpoint, [HEALTH]) as honest:
            attend_until(publisher, lambda: honest.receive(0) is not None)
        attend_until(publisher, lambda: publisher.refused >= 10)
    finally:
        for line in lines:
            line.close()


def test_half_a_greeting_is_not_waited_for(publisher: Publisher) -> None:
    with open_line(port_of(publisher)) as line:
        line.sendall(handshake(b"SUB")[:11])
        while line.recv(1000):
            pass


@pytest.mark.parametrize("size", [1, 100, 1000])
def test_a_request_without_end_is_shown_out(context: "zmq.Context[zmq.Socket[bytes]]", size: int) -> None:
    limit = 2_000_000
    with context.socket(zmq.ROUTER) as router:
        peers = Peers(context, router, limit)
        port = router.bind_to_random_port("tcp://127.0.0.1")
        peers.watch()
        try:
            with context.socket(zmq.DEALER) as honest, open_line(port) as line:
                before = psutil.Process().memory_info().rss
                greet(line, b"DEALER")
                sent = send_until_shown_out(line, parts_without_end(size), MOST_SENT)
                assert sent < MOST_SENT
                assert peers.refused == 1
                # how much it has got in until it is looked at depends on the machine
                most = MOST_GROWN + sent * (KEPT + size) / (HEADER + size)
                assert psutil.Process().memory_info().rss - before < most
                honest.linger = 0
                honest.connect(f"tcp://127.0.0.1:{port}")
                for _ in range(300):  # more than the limit, but read
                    honest.send(bytes(limit // 100))
                    assert router.poll(PATIENCE_MS)
                    received = receive_parts(router, limit)
                    peers.handed(received.first, received.n_byte)
                assert peers.refused == 1
        finally:
            peers.close()


def test_who_gets_the_number_of_one_that_left_is_read_too(context: "zmq.Context[zmq.Socket[bytes]]") -> None:
    """A descriptor's number is given to the next connection at once; nobody looks meanwhile."""
    limit, sent = 200_000, bytes(20_000)
    with context.socket(zmq.ROUTER) as router:
        peers = Peers(context, router, limit)
        port = router.bind_to_random_port("tcp://127.0.0.1")
        places: dict[int, int] = {}
        place = (-1, -1)
        try:
            while places.setdefault(place[0], place[1]) == place[1]:  # until a number comes again
                end_s = time.monotonic() + PATIENCE_S
                while _is_open(*place) and time.monotonic() < end_s:
                    time.sleep(PAUSE_S)
                with context.socket(zmq.DEALER) as honest:
                    honest.connect(f"tcp://127.0.0.1:{port}")
                    for _ in range(30):  # more than the limit, but read
                        honest.send(sent)
                        assert router.poll(PATIENCE_MS)
                        received = receive_parts(router, len(sent))
                        handed = peers.handed(received.first, received.n_byte)
                        assert handed is not None
                        place = handed
                    if place[0] in places:
                        peers.look()
                        assert peers.refused == 0
        finally:
            peers.close()


def _is_open(descriptor: int, inode: int) -> bool:
    try:
        return os.fstat(descriptor).st_ino == inode
    except OSError:
        return False


def test_of_many_parts_few_are_kept(context: "zmq.Context[zmq.Socket[bytes]]") -> None:
    with context.socket(zmq.PAIR) as one, context.socket(zmq.PAIR) as two:
        one.bind("inproc://pair")
        two.connect("inproc://pair")
        one.send_multipart([bytes(10)] * 10_000)
        one.send_multipart([bytes(60), bytes(60), b"x"])
        one.send(b"next")
        received = receive_parts(two, 1000)
        assert (len(received.parts), received.parts[0]) == (MOST_PARTS, bytes(10))
        assert received.n_byte > 10_000 * 10
        assert receive_parts(two, 100).parts == [bytes(60), b"", b"x"]
        assert receive_parts(two, 100).parts == [b"next"]
        with pytest.raises(zmq.Again):
            receive_parts(two, 100)


def test_a_frame_is_as_the_standard_says() -> None:
    assert frame(b"\x01a") == b"\x00\x02\x01a"
    assert frame(bytes(256)) == b"\x02" + bytes(6) + b"\x01\x00" + bytes(256)
