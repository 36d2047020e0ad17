"""From pipeline to recorder: every message, byte for byte, in its order; what is lost is counted."""

from collections.abc import Iterator

import pytest
import zmq

from daemon.recording import record_link as module
from daemon.recording.record_link import Entry, RecordInlet, RecordLink

Context = zmq.Context[zmq.Socket[bytes]]
WAIT_S = 10.0


@pytest.fixture
def context() -> Iterator[Context]:
    with zmq.Context() as made:
        yield made


@pytest.fixture
def inlet(context: Context) -> Iterator[RecordInlet]:
    made = RecordInlet(context, "inproc://recorder")
    yield made
    made.close()


@pytest.fixture
def link(context: Context, inlet: RecordInlet) -> Iterator[RecordLink]:
    made = RecordLink(context, "inproc://recorder", "first.mcap")
    yield made
    made._socket.close(0)


def test_messages_arrive_as_they_were_together_and_in_order(link: RecordLink, inlet: RecordInlet) -> None:
    sent = [Entry("limb/raw", bytes([k, 0, 255]), 10**18 + k) for k in range(3)]
    for one in sent:
        link.write([one.topic.encode(), one.payload], one.t_ns)
    link.flush()
    assert not inlet.linked
    assert inlet.receive(WAIT_S) == []  # it has come
    assert inlet.linked and not inlet.ended
    assert inlet.receive(WAIT_S) == sent
    assert inlet.receive(0.0) == []
    link.write([b"limb/raw", b"last"], 5)
    link.close()
    assert inlet.receive(WAIT_S) == [Entry("limb/raw", b"last", 5)]
    assert not inlet.ended
    assert inlet.receive(WAIT_S) == [] and inlet.ended
    assert link.lost == 0


def test_they_gather_for_a_quarter_of_a_second(
    link: RecordLink, inlet: RecordInlet, monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = 100.0
    monkeypatch.setattr(module.time, "monotonic", lambda: now_s)
    link.flush()
    inlet.receive(WAIT_S)
    link.write([b"a", b"1"], 1)
    now_s = 100.24
    link.poll()
    assert inlet.receive(0.0) == []
    link.write([b"a", b"2"], 2)
    now_s = 100.26
    link.poll()
    assert [one.t_ns for one in inlet.receive(WAIT_S)] == [1, 2]
    link.poll()
    assert inlet.receive(0.0) == []


def test_the_pipeline_hears_what_is_recorded_to(link: RecordLink, inlet: RecordInlet) -> None:
    assert link.recording == "first.mcap"
    inlet.receive(WAIT_S)
    inlet.tell("second.mcap", 1)
    assert link._socket.poll(1000 * WAIT_S)
    link.check()
    assert (link.recording, link.removed) == ("second.mcap", 1)
    inlet.tell(None, 2)
    inlet.tell("third.mcap", 2)
    assert link._socket.poll(1000 * WAIT_S)
    link.check()
    assert (link.recording, link.removed) == ("third.mcap", 2)


def test_a_pipeline_that_comes_later_hears_it_then(context: Context, inlet: RecordInlet) -> None:
    inlet.tell("day.mcap", 3)
    link = RecordLink(context, "inproc://recorder", "unknown")
    try:
        inlet.receive(WAIT_S)
        assert link._socket.poll(1000 * WAIT_S)
        link.check()
        assert (link.recording, link.removed) == ("day.mcap", 3)
    finally:
        link._socket.close(0)


def test_what_a_recorder_that_stands_still_has_no_room_for_is_counted(
    context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_QUEUE", 1)
    inlet = RecordInlet(context, "inproc://slow")
    link = RecordLink(context, "inproc://slow", "first.mcap")
    try:
        n = 0
        while not link.lost:
            for _ in range(7):
                link.write([b"a", b""], n)
                n += 1
            link.flush()
        assert link.lost == 7
        came: list[Entry] = []
        inlet.receive(WAIT_S)
        while len(came) < n - 7:
            came += inlet.receive(WAIT_S)
        assert [one.t_ns for one in came] == list(range(n - 7))
    finally:
        link._socket.close(0)
        inlet.close()
