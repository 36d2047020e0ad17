"""The device's end of the haptic channel: neither saying nor hearing ever waits."""

import threading
from collections.abc import Iterator

import numpy as np
import pytest
import zmq

from limbcal.errors import ConfigError, DeviceError, ProtocolError
from playback.touch.channel import HapticChannel, Heard
from playback.touch.device import TouchDevice
from playback.touch.message import Command, Input
from tests.patience import PATIENCE_MS

Context = zmq.Context[zmq.Socket[bytes]]


@pytest.fixture
def channel(own_context: Context) -> Iterator[HapticChannel]:
    made = HapticChannel(own_context, "tcp://127.0.0.1:*", 2)
    yield made
    made.close()


@pytest.fixture
def device(own_context: Context, channel: HapticChannel) -> Iterator[TouchDevice]:
    with TouchDevice(own_context, channel.endpoint) as made:
        yield made


def heard_after(device: TouchDevice, channel: HapticChannel, seq: int) -> Heard:
    """Wait until the input with a number has come."""
    for _ in range(PATIENCE_MS // 10):
        for one in channel.drain():
            if isinstance(one.said, Input) and one.said.seq == seq:
                return one
        channel._socket.poll(10)
    raise AssertionError(f"input {seq} did not come")


def test_inputs_are_numbered_from_nought(device: TouchDevice, channel: HapticChannel) -> None:
    assert device.seq == -1
    assert device.send([0.1, 0.2, 0.3]) == 0
    said = heard_after(device, channel, 0).said
    assert isinstance(said, Input)
    assert said.position.tolist() == [0.1, 0.2, 0.3]
    assert (said.velocity, said.joint, said.point, said.orientation) == (None, None, None, None)
    place, velocity, point = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]), np.array([0.7, 0.8, 0.9])
    assert device.send(place, velocity, 1, point, [1.0, 0.0, 0.0, 0.0]) == 1
    said = heard_after(device, channel, 1).said
    assert isinstance(said, Input) and said.velocity is not None and said.orientation is not None
    assert (said.position.tolist(), said.velocity.tolist()) == ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])
    assert (said.joint, said.point) == (1, (0.7, 0.8, 0.9))
    assert said.orientation == pytest.approx(np.eye(3))


def test_only_the_newest_answer_is_heard(device: TouchDevice, channel: HapticChannel) -> None:
    device.send([0.1, 0.2, 0.3])
    one = heard_after(device, channel, 0)
    assert device.latest() is None
    for seq in range(3):
        channel.answer(one.envelope, {"seq": seq, "force": [float(seq), 0.0, 0.0]})
    newest = None
    while newest is None or newest["seq"] != 2:
        answer = device.wait(PATIENCE_MS)
        assert answer is not None
        newest = answer
    assert newest["force"] == [2.0, 0.0, 0.0] and device.latest() is None
    channel.answer(one.envelope, {"error": "no such joint"})
    with pytest.raises(ProtocolError, match="the haptic loop refused: no such joint"):
        device.wait(PATIENCE_MS)


def test_a_question_has_its_answer(device: TouchDevice, channel: HapticChannel) -> None:
    asked: list[Command] = []

    def serve() -> None:
        while not asked:
            channel._socket.poll(10)
            for one in channel.drain():
                assert isinstance(one.said, Command)
                asked.append(one.said)
                said = {"error": "not now"} if one.said.cmd == "hold" else {"point": [1.0, 2.0, 3.0]}
                channel.answer(one.envelope, said)

    for cmd in ("reset", "hold"):
        asked.clear()
        thread = threading.Thread(target=serve)
        thread.start()
        try:
            if cmd == "hold":
                with pytest.raises(ProtocolError, match="the haptic loop refused: not now"):
                    device.ask(cmd, timeout_ms=PATIENCE_MS)
            else:
                assert device.ask(cmd, [0.1, 0.2], PATIENCE_MS)["point"] == [1.0, 2.0, 3.0]
                assert asked[0].q is not None and asked[0].q.tolist() == [0.1, 0.2]
        finally:
            thread.join()


def test_nobody_there_keeps_nobody_waiting(own_context: Context) -> None:
    with TouchDevice(own_context, "tcp://127.0.0.1:9") as device:
        for k in range(3000):
            assert device.send([0.0, 0.0, 0.0]) == k
        assert device.latest() is None and device.wait(1) is None
        with pytest.raises(DeviceError, match=r"haptic endpoint tcp://127\.0\.0\.1:9: no answer within 0\.05 s"):
            device.ask("state", timeout_ms=50)


def test_where_it_is_to_be_spoken_to_must_be_an_endpoint(own_context: Context) -> None:
    with pytest.raises(ConfigError, match="endpoint is 'nonsense'"):
        TouchDevice(own_context, "nonsense")
