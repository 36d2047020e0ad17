"""The receiving end on real sockets, and what it counts as missed."""

import threading

import pytest
import zmq

import protocol.publisher
import protocol.subscriber
from limbcal.errors import ConfigError, ProtocolError
from protocol.message import FRAMES, HEALTH, PLOT, RAW, encode
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber


@pytest.fixture
def context():
    with zmq.Context() as opened:
        yield opened


@pytest.fixture
def publisher(context):
    with Publisher(context, "tcp://127.0.0.1:*", "dd-arm", "first-run") as opened:
        yield opened


@pytest.fixture
def subscriber(context, publisher):
    """Return a subscriber that has received its first message, number ``last_seq``."""
    with Subscriber(context, publisher.endpoint, [FRAMES, HEALTH]) as opened:
        join(publisher, opened)
        yield opened


def join(publisher, subscriber):
    """Publish until the subscription has arrived, and take all that came."""
    while (received := subscriber.receive(5)) is None:
        publisher.publish(FRAMES, {})
    while received[1]["seq"] < publisher.last_seq[FRAMES]:
        received = subscriber.receive(1000)


def test_messages_arrive_in_order_and_none_is_missed(publisher, subscriber):
    begun = publisher.last_seq[FRAMES] + 1
    for _ in range(50):
        publisher.publish(FRAMES, {})
    numbers = [subscriber.receive(1000)[1]["seq"] for _ in range(50)]
    assert numbers == list(range(begun, begun + 50))
    assert subscriber.missed == {}
    assert subscriber.run == "first-run"


def test_one_follows_another_on_one_context(context, publisher):
    """Each has a monitor, whose name is free only some time after its socket has closed."""
    for _ in range(100):
        with Subscriber(context, publisher.endpoint, [FRAMES]) as opened:
            assert opened.receive(0) is None


def test_nothing_in_time_is_none(subscriber):
    assert subscriber.receive(0) is None


def test_only_the_topics_asked_for_arrive(publisher, subscriber):
    publisher.publish(RAW, {})
    publisher.publish(FRAMES, {"x": 1})
    topic, fields = subscriber.receive(1000)
    assert (topic, fields["x"]) == (FRAMES, 1)


def test_a_jump_of_the_numbers_is_counted(publisher, subscriber):
    publisher.last_seq[FRAMES] += 3
    publisher.publish(FRAMES, {})
    subscriber.receive(1000)
    assert subscriber.missed == {FRAMES: 3}


def test_a_lost_tail_shows_in_the_heartbeat_and_is_counted_once(publisher, subscriber):
    publisher.last_seq[FRAMES] += 4
    publisher.publish(HEALTH, {"last_seq": dict(publisher.last_seq)})
    subscriber.receive(1000)
    assert subscriber.missed == {FRAMES: 4}
    publisher.publish(FRAMES, {})
    subscriber.receive(1000)
    assert subscriber.missed == {FRAMES: 4}


def test_a_topic_that_was_never_heard_of_is_not_missed(publisher, subscriber):
    publisher.publish(HEALTH, {"last_seq": {RAW: 100, "junk": "x"}})
    subscriber.receive(1000)
    assert subscriber.missed == {}


def test_a_publisher_that_starts_anew_is_no_loss(context, tmp_path):
    endpoint = f"ipc://{tmp_path}/pub"
    with Subscriber(context, endpoint, [""]) as subscriber:
        for run in ("one", "two", "three"):
            # a context of its own, as in a process of its own, frees the endpoint when it ends
            with zmq.Context() as other, Publisher(other, endpoint, "dd-arm", run) as publisher:
                publisher.last_seq[FRAMES] = 1000 * len(run)
                join(publisher, subscriber)
            assert subscriber.run == run
        assert subscriber.restarts == 2
        assert subscriber.missed == {}


def test_a_stall_loses_only_what_is_counted(context, monkeypatch):
    monkeypatch.setattr(protocol.publisher, "SEND_QUEUE", 4)
    monkeypatch.setattr(protocol.subscriber, "RECEIVE_QUEUE", 4)
    with (
        Publisher(context, "tcp://127.0.0.1:*", "dd-arm", "run") as publisher,
        Subscriber(context, publisher.endpoint, [FRAMES, HEALTH]) as subscriber,
    ):
        join(publisher, subscriber)
        begun = publisher.last_seq[FRAMES]
        for _ in range(200):
            publisher.publish(FRAMES, {"x": bytes(200_000)})
        received, topic = 0, FRAMES
        while topic != HEALTH:
            publisher.publish(HEALTH, {"last_seq": dict(publisher.last_seq)})
            while (message := subscriber.receive(20)) is not None:
                topic = message[0]
                received += topic == FRAMES
        assert 0 < received < 200
        assert received + subscriber.missed[FRAMES] == publisher.last_seq[FRAMES] - begun


def test_plots_are_counted_too(context, publisher):
    with Subscriber(context, publisher.endpoint, [PLOT]) as subscriber:
        while subscriber.receive(5) is None:
            publisher.publish(PLOT, {"rows": [{"ts": 0.0}]})
        while subscriber.receive(20) is not None:
            pass
        publisher.last_seq[PLOT] += 2
        publisher.publish(PLOT, {"rows": [{"ts": 0.0}]})
        topic, fields = subscriber.receive(1000)
        assert fields["rows"] == [{"ts": 0.0}]
        assert subscriber.missed == {PLOT: 2}


def test_another_version_is_said_and_the_next_message_received(context):
    with context.socket(zmq.PUB) as socket, Subscriber(context, "inproc://foreign", [""]) as subscriber:
        socket.bind("inproc://foreign")
        while not subscriber._socket.poll(5):
            socket.send_multipart([FRAMES.encode(), b"\x81\xa1v\x02"])
        with pytest.raises(ProtocolError, match="message version is 2, expected 1"):
            subscriber.receive(1000)
        socket.send_multipart([FRAMES.encode(), b"\x82\xa1v\x01\xa1x\x07"])
        received = None
        while received is None:
            try:
                received = subscriber.receive(1000)
            except ProtocolError:
                pass  # more of the first kind
        assert received == (FRAMES, {"v": 1, "x": 7})


def test_what_is_no_endpoint_is_said(context):
    with pytest.raises(ConfigError, match="endpoint is '5770'"):
        Subscriber(context, "5770", [""])


def test_close_may_be_repeated(context):
    subscriber = Subscriber(context, "tcp://127.0.0.1:1", [""])
    subscriber.close()
    subscriber.close()


@pytest.mark.parametrize("watched", [False, True])
def test_a_thread_looks_only_where_it_is_wanted(context, publisher, watched):
    before = set(threading.enumerate())
    with Subscriber(context, publisher.endpoint, [""], watched=watched):
        assert len(set(threading.enumerate()) - before) == watched
    assert not set(threading.enumerate()) - before


def test_messages_without_numbers_count_for_nothing(publisher, subscriber):
    last = publisher.last_seq[FRAMES]
    for fields in ({"seq": "x"}, {"run": 5}, {}):
        publisher.socket.send_multipart(encode(FRAMES, fields))
        assert subscriber.receive(1000)[1] == {**fields, "v": 1}
    assert (subscriber.missed, subscriber.restarts, subscriber.run) == ({}, 0, "first-run")
    publisher.socket.send_multipart(encode(FRAMES, {"seq": last + 1, "run": "first-run"}))
    subscriber.receive(1000)
    publisher.socket.send_multipart(encode(FRAMES, {"seq": last + 3, "run": "first-run"}))
    subscriber.receive(1000)
    assert subscriber.missed == {FRAMES: 1}
    publisher.socket.send_multipart(encode(FRAMES, {"seq": last + 3, "run": "first-run"}))  # twice
    subscriber.receive(1000)
    assert subscriber.missed == {FRAMES: 1}


def test_only_a_heartbeat_tells_of_other_topics(publisher, subscriber):
    last = publisher.last_seq[FRAMES]
    publisher.socket.send_multipart(encode(FRAMES, {"last_seq": {FRAMES: last + 9}}))
    subscriber.receive(1000)
    assert subscriber.missed == {}
    for counts_sent in ([FRAMES], {FRAMES: "x"}, {FRAMES: last}, {FRAMES: last - 5}, {FRAMES: last + 2}):
        publisher.socket.send_multipart(encode(HEALTH, {"last_seq": counts_sent}))
        subscriber.receive(1000)
    assert subscriber.missed == {FRAMES: 2}
