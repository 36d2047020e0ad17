"""What comes is kept while its owner is busy, in order, in memory and on the disk."""

import tempfile

import pytest
import zmq

from limbcal.errors import DeviceError, ProtocolError
from protocol.inbox import Inbox
from protocol.message import FRAMES
from protocol.publisher import Publisher
from protocol.spilling_queue import SpillingQueue
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS


@pytest.fixture
def wire():
    """Return a publisher and a subscriber that it knows."""
    with tempfile.TemporaryDirectory() as folder, zmq.Context() as context:
        endpoint = f"ipc://{folder}/wire"
        with (
            Publisher(context, endpoint, "an arm", "a run") as publisher,
            Subscriber(context, endpoint, ("",)) as subscriber,
        ):
            assert publisher.socket.poll(PATIENCE_MS)
            assert publisher.joined()
            yield publisher, subscriber


def test_all_that_was_sent_while_nobody_took_it_comes_in_order(wire):
    publisher, subscriber = wire
    sent = 900  # fewer than the publisher keeps
    with Inbox(subscriber, SpillingQueue(10_000, 20_000)) as inbox:
        for _ in range(sent):
            publisher.publish(FRAMES, {"d": bytes(200)})
        numbers = [inbox.receive(PATIENCE_MS)[1]["seq"] for _ in range(sent)]
        assert numbers == list(range(sent))
        assert len(inbox) == 0 and inbox.receive(0) is None


def test_what_had_come_before_a_stop_can_still_be_taken(wire):
    publisher, subscriber = wire
    with Inbox(subscriber) as inbox:
        for _ in range(3):
            publisher.publish(FRAMES, {})
        assert inbox.receive(PATIENCE_MS)[1]["seq"] == 0
        while len(inbox) < 2:
            assert inbox._thread.is_alive()
        inbox.stop()
        inbox.stop()
        publisher.publish(FRAMES, {})
        assert [inbox.receive(0)[1]["seq"] for _ in range(2)] == [1, 2]
        assert inbox.receive(0) is None


def test_a_message_that_is_none_is_used_up(wire):
    publisher, subscriber = wire
    with Inbox(subscriber) as inbox:
        publisher.socket.send(b"alone")
        publisher.publish(FRAMES, {})
        with pytest.raises(ProtocolError, match="message of 1 parts"):
            inbox.receive(PATIENCE_MS)
        assert inbox.receive(PATIENCE_MS)[1]["seq"] == 0


def test_a_full_disk_is_told_after_all_that_came_before(wire, tmp_path):
    publisher, subscriber = wire
    queue = SpillingQueue(200, directory=tmp_path / "gone")
    with Inbox(subscriber, queue) as inbox:
        for _ in range(2):
            publisher.publish(FRAMES, {"d": bytes(100)})
        inbox._thread.join(PATIENCE_MS / 1000)
        assert not inbox._thread.is_alive()
        assert inbox.receive(0)[1]["seq"] == 0
        with pytest.raises(DeviceError, match="1 messages wait, and the next cannot be written"):
            inbox.receive(0)
