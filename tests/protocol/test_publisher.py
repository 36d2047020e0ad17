"""The sending end on real sockets."""

import threading

import msgpack
import pytest
import zmq

from limbcal.errors import ConfigError, DeviceError, ProtocolError
from protocol.curve import gate_of, new_client
from protocol.message import FRAMES, HEALTH, decode
from protocol.publisher import Publisher


@pytest.fixture
def context():
    with zmq.Context() as opened:
        yield opened


@pytest.fixture
def publisher(context):
    with Publisher(context, "tcp://127.0.0.1:*", "dd-arm", "a-run") as opened:
        yield opened


def test_the_endpoint_says_the_real_port(publisher):
    assert int(publisher.endpoint.removeprefix("tcp://127.0.0.1:")) > 0


def test_messages_are_numbered_by_topic(publisher):
    sent = [publisher.publish(topic, {"x": 1}) for topic in (FRAMES, FRAMES, HEALTH, FRAMES)]
    assert [decode(parts)[1]["seq"] for parts in sent] == [0, 1, 0, 2]
    assert publisher.last_seq == {FRAMES: 2, HEALTH: 0}
    assert decode(sent[0]) == (FRAMES, {"v": 1, "arm": "dd-arm", "run": "a-run", "seq": 0, "x": 1})


def test_a_plain_socket_receives_the_very_bytes(context, publisher):
    with context.socket(zmq.SUB) as socket:
        socket.setsockopt(zmq.SUBSCRIBE, b"limb/frames")
        socket.connect(publisher.endpoint)
        sent = []
        while not socket.poll(5):  # until the subscription has arrived
            sent.append(publisher.publish(FRAMES, {"x": 1.5}))
        received = socket.recv_multipart()
    assert received in sent
    assert msgpack.unpackb(received[1])["x"] == 1.5


def test_what_cannot_be_sent_uses_up_no_number(publisher):
    with pytest.raises(ProtocolError):
        publisher.publish(FRAMES, {"x": object()})
    assert publisher.last_seq == {}
    assert decode(publisher.publish(FRAMES, {}))[1]["seq"] == 0


@pytest.mark.parametrize("transport", ["tcp", "ipc"])
def test_a_taken_endpoint_is_said(context, tmp_path, transport):
    wanted = "tcp://127.0.0.1:*" if transport == "tcp" else f"ipc://{tmp_path}/pub"
    with Publisher(context, wanted, "a", "1") as first:
        with pytest.raises(DeviceError) as error:
            Publisher(context, first.endpoint, "a", "2")
    assert str(error.value) == f"endpoint {first.endpoint} is already taken, expected a free one"


def test_an_ipc_file_left_over_is_no_hindrance(tmp_path):
    endpoint = f"ipc://{tmp_path}/pub"
    for run in ("1", "2"):
        with zmq.Context() as context, Publisher(context, endpoint, "a", run) as publisher:
            assert publisher.endpoint == endpoint


@pytest.mark.parametrize(
    "endpoint", ["5770", "", "http://127.0.0.1:5770", "tcp://127.0.0.1:70000", "tcp://127.0.0.1"]
)
def test_what_is_no_endpoint_is_said(context, endpoint):
    with pytest.raises(ConfigError, match="endpoint is"):
        Publisher(context, endpoint, "a", "1")


def test_an_address_of_another_machine_is_said(context, tmp_path):
    new_client(tmp_path, "somebody", tmp_path / "somebody.limbkey")
    with gate_of(context, tmp_path) as gate, pytest.raises(DeviceError, match="cannot be bound"):
        Publisher(context, "tcp://192.0.2.1:5770", "a", "1", gate)


def test_close_may_be_repeated(context):
    publisher = Publisher(context, "tcp://127.0.0.1:*", "a", "1")
    publisher.close()
    publisher.close()


@pytest.mark.parametrize("watched", [False, True])
def test_a_thread_looks_only_where_it_is_wanted(context, watched):
    before = set(threading.enumerate())
    with Publisher(context, "tcp://127.0.0.1:*", "a", "1", watched=watched):
        assert len(set(threading.enumerate()) - before) == watched
    assert not set(threading.enumerate()) - before
