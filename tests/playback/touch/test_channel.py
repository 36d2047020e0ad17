"""Of each device the newest input counts, and every command."""

from collections.abc import Iterator

import pytest
import zmq

from playback.touch.channel import AT_ONCE, HapticChannel, Heard
from playback.touch.message import Command, Input, decode_reply, encode_input
from tests.patience import PATIENCE_MS

Context = zmq.Context[zmq.Socket[bytes]]


@pytest.fixture
def context() -> Iterator[Context]:
    made: Context = zmq.Context()
    yield made
    made.destroy(linger=0)  # and what a test that failed has left open


@pytest.fixture
def channel(context: Context) -> Iterator[HapticChannel]:
    made = HapticChannel(context, "tcp://127.0.0.1:*", 2)
    yield made
    made.close()


def device(context: Context, channel: HapticChannel, *inputs: dict[str, object]) -> "zmq.Socket[bytes]":
    """Send inputs, and return once all of them are there to be drained."""
    socket = context.socket(zmq.DEALER)
    socket.set(zmq.LINGER, 0)
    socket.connect(channel.endpoint)
    for fields in inputs:
        socket.send(encode_input(fields))
    return socket


def drained(channel: HapticChannel, last: int) -> list[Heard]:
    """Wait until the input with this number has come, and all before it."""
    heard: list[Heard] = []
    for _ in range(PATIENCE_MS // 10):
        heard += channel.drain()
        if any(one.said.seq == last for one in heard):
            return heard
        channel._socket.poll(10)
    raise AssertionError(f"input {last} did not come")


def place(seq: int, x: float) -> dict[str, object]:
    return {"position": [x, 0.0, 0.0], "seq": seq}


def test_the_newest_of_what_came_together_counts(context: Context, channel: HapticChannel) -> None:
    inputs = [place(seq, 0.01 * seq) for seq in range(1, 9)]
    socket = device(context, channel, *inputs)
    heard = drained(channel, 8)
    said = [one.said for one in heard]
    assert all(isinstance(one, Input) for one in said)
    assert [one.seq for one in said] == sorted(one.seq for one in said if one.seq is not None)
    for one in said:
        assert isinstance(one, Input) and one.seq is not None
        assert one.position[0] == pytest.approx(0.01 * one.seq)
    assert said[-1].seq == 8
    socket.close()


def test_one_drain_gives_the_newest_of_each_device(context: Context, channel: HapticChannel) -> None:
    sockets = [device(context, channel, *(place(10 * k + n, 0.1 * n) for n in range(5))) for k in (1, 2, 3)]
    heard: list[Heard] = []
    while {14, 24, 34} - {one.said.seq for one in heard}:  # the last of each, however they came together
        assert channel._socket.poll(PATIENCE_MS), f"only {[one.said.seq for one in heard]} came"
        together = list(channel.drain())
        assert len({one.envelope[0] for one in together}) == len(together)  # never two of one device
        heard += together
    newest: dict[bytes, int] = {}
    for one in heard:
        assert one.said.seq is not None
        assert one.said.seq > newest.get(one.envelope[0], -1)
        newest[one.envelope[0]] = one.said.seq
    assert sorted(newest.values()) == [14, 24, 34]
    for socket in sockets:
        socket.close()


def test_commands_are_never_overtaken(context: Context, channel: HapticChannel) -> None:
    socket = device(
        context, channel, {"cmd": "hold", "seq": 1}, place(2, 0.1), {"cmd": "free", "seq": 3}, place(4, 0)
    )
    commands = [one.said for one in drained(channel, 4) if isinstance(one.said, Command)]
    assert [(one.cmd, one.seq) for one in commands] == [("hold", 1), ("free", 3)]
    socket.close()


def test_a_flood_costs_a_tick_no_more_than_a_part_of_it(context: Context, channel: HapticChannel) -> None:
    socket = device(context, channel, *({"cmd": "state", "seq": k} for k in range(3 * AT_ONCE)))
    assert channel._socket.poll(PATIENCE_MS)
    assert len(list(channel.drain())) <= AT_ONCE
    socket.close()


@pytest.mark.parametrize(
    ("parts", "answer"),
    [
        ([b"", encode_input({"position": [0, 0]})], [b"", "expected 3 numbers"]),  # as REQ sends it
        ([encode_input({"position": [0, 0]})], ["expected 3 numbers"]),
        ([b""], ["not msgpack"]),
        ([b"x", b"y"], ["input: 2 parts, expected 1"]),
        ([b"", b"x", b"y"], [b"", "input: 2 parts, expected 1"]),
        ([bytes(8000)], ["8000 bytes, expected at most 4096"]),
    ],
)
def test_what_is_no_input_is_answered_the_way_it_came(
    context: Context, channel: HapticChannel, parts: list[bytes], answer: list[bytes | str]
) -> None:
    socket = device(context, channel)
    socket.send_multipart(parts)
    assert channel._socket.poll(PATIENCE_MS)
    assert list(channel.drain()) == []
    assert socket.poll(PATIENCE_MS)
    *envelope, said = socket.recv_multipart()
    assert [*envelope] == answer[:-1]
    assert str(answer[-1]) in decode_reply(said)["error"]
    socket.close()


def test_an_envelope_is_an_address_and_what_req_adds(context: Context, channel: HapticChannel) -> None:
    socket = device(context, channel)
    socket.send_multipart([b"", encode_input({"cmd": "state", "seq": 1})])
    (heard,) = drained(channel, 1)
    assert len(heard.envelope) == 2 and heard.envelope[1] == b""
    socket.send(encode_input(place(2, 0.5)))
    (heard,) = drained(channel, 2)
    assert len(heard.envelope) == 1
    channel.answer(heard.envelope, {"seq": 2})
    assert socket.poll(PATIENCE_MS) and decode_reply(socket.recv())["seq"] == 2
    socket.close()
