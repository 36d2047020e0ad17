"""Subscribers' topics: whoever asks for too much is shown out; who joins is noticed once."""

from collections.abc import Callable, Iterator

import pytest
import zmq

from protocol.subscriptions import MOST_TOPICS, TOPIC_LIMIT, Subscriptions

PATIENCE_MS, TRIES = 100, 300
Served = tuple["zmq.Context[zmq.Socket[bytes]]", Subscriptions, str]


@pytest.fixture
def served() -> Iterator[Served]:
    with zmq.Context() as context, context.socket(zmq.XPUB) as socket:
        subscriptions = Subscriptions(context, socket)
        port = socket.bind_to_random_port("tcp://127.0.0.1")
        yield context, subscriptions, f"tcp://127.0.0.1:{port}"
        subscriptions.peers.close()


def looked(subscriptions: Subscriptions, until: Callable[[], bool]) -> None:
    for _ in range(TRIES):
        subscriptions._socket.poll(PATIENCE_MS)
        subscriptions.look()
        if until():
            return
    pytest.fail("it never came to that")


def test_who_joins_is_noticed_once(served: Served) -> None:
    context, subscriptions, endpoint = served
    with context.socket(zmq.SUB) as honest:
        honest.connect(endpoint)
        honest.subscribe(b"t" * TOPIC_LIMIT)
        looked(subscriptions, subscriptions.joined)
        assert not subscriptions.joined()
        assert subscriptions.peers.refused == 0


@pytest.mark.parametrize(
    "topics", [[b"t" * (TOPIC_LIMIT + 1)], [b"%d" % k for k in range(MOST_TOPICS + 1)]], ids=["long", "many"]
)
def test_who_asks_for_too_much_is_shown_out(served: Served, topics: list[bytes]) -> None:
    context, subscriptions, endpoint = served
    with context.socket(zmq.SUB) as greedy:
        greedy.connect(endpoint)
        for topic in topics:
            greedy.subscribe(topic)
        looked(subscriptions, lambda: subscriptions.peers.refused > 0)
        greedy.linger = 0


def test_sixty_four_topics_at_a_time_are_no_more_than_there_may_be(served: Served) -> None:
    context, subscriptions, endpoint = served
    with context.socket(zmq.SUB) as honest:
        honest.linger = 0
        honest.connect(endpoint)
        for k in range(64):
            honest.subscribe(b"%02d" % k)
        for k in range(10):
            honest.unsubscribe(b"%02d" % k)
            honest.subscribe(b"other %d" % k)

        def heard() -> bool:
            subscriptions._socket.send(b"other 9")
            return bool(honest.poll(20))

        looked(subscriptions, heard)
        assert subscriptions.peers.refused == 0


def test_what_is_no_topic_is_shown_out(served: Served) -> None:
    context, subscriptions, endpoint = served
    with context.socket(zmq.XSUB) as rude:
        rude.linger = 0
        rude.connect(endpoint)
        rude.send(b"hello")
        looked(subscriptions, lambda: subscriptions.peers.refused > 0)
        assert not subscriptions.joined()
