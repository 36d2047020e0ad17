"""The haptic loop as devices and subscribers meet it: real sockets, a real process."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
import psutil
import pytest
import zmq

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from limbcal.errors import ConfigError, DataError, DeviceError, ProtocolError
from playback.touch.device import TouchDevice
from playback.touch.process import TouchProcess
from protocol.curve import load_client_key, new_client
from protocol.message import HEALTH, PLAY
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS, PATIENCE_S


def pull(device: TouchDevice, x: Any, until: Any, **grip: Any) -> dict[str, Any]:
    """Say where the hand is until an answer is as it should be; return that."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        device.send(x, **grip)
        answer = device.wait(10)
        if answer is not None and until(answer):
            return answer
    pytest.fail("the answer never came")


def strong(answer: dict[str, Any]) -> bool:
    return bool(np.linalg.norm(answer["force"]) > 2.0)


def test_a_hand_is_answered_with_what_it_feels(loop: TouchProcess, own_context) -> None:
    with TouchDevice(own_context, loop.haptic) as device:
        state = device.ask("reset", [0.3, 0.6])
        assert (state["holds"], state["stale"], state["q"]) == (False, True, [0.3, 0.6])
        tip = np.array(state["point"])
        np.testing.assert_allclose(tip, tip_position(load_arm("dd-arm"), np.array([[0.3, 0.6]]))[0], atol=1e-12)
        # Back to where the arm is; on a machine kept busy it may have swung past the hand by the first answer.
        answer = pull(device, tip + [0.0, 0.03, 0.0], lambda answer: answer["force"][1] < -2.0)
        assert answer.keys() >= {"v", "force", "moment", "q", "dq", "point", "t_ns", "seq", "stale", "holds"}
        assert (answer["holds"], answer["stale"], answer["moment"]) == (True, False, [0.0, 0.0, 0.0])
        assert answer["seq"] <= device.seq
        inner = pull(device, tip, lambda answer: answer["holds"], joint=1, point=[0.1, 0.0, 0.0])
        q1 = inner["q"][0]
        np.testing.assert_allclose(inner["point"], 0.1 * np.array([np.cos(q1), np.sin(q1), 0.0]), atol=1e-12)


def test_a_silent_hand_holds_nothing_and_its_force_grows_anew(loop: TouchProcess, own_context) -> None:
    with TouchDevice(own_context, loop.haptic) as device:
        tip = np.array(device.ask("reset", [0.3, 0.6])["point"])
        pull(device, tip + [0.0, 0.03, 0.0], strong)
        while not device.ask("state")["stale"]:
            pass
        health = loop.wait_health()
        assert (health["stale"], health["connected"], health["force_N"]) == (True, False, 0.0)
        assert health["energy_J"]["stored"] == 0.0
        device.latest()
        device.send(tip + [0.0, 0.03, 0.0])
        first = device.wait(1000)
        assert first is not None
        assert np.linalg.norm(first["force"]) < 1.0


def test_the_newest_device_holds_the_arm_and_the_other_is_told(loop: TouchProcess, own_context) -> None:
    with TouchDevice(own_context, loop.haptic) as one, TouchDevice(own_context, loop.haptic) as two:
        tip = np.array(one.ask("reset", [0.3, 0.6])["point"])
        pull(one, tip, lambda answer: answer["holds"])

        def both(answer: dict[str, Any]) -> bool:
            one.send(tip + [0.0, 0.05, 0.0])
            last = one.latest()
            return answer["holds"] and last is not None and not last["holds"] and last["force"] == [0.0, 0.0, 0.0]

        pull(two, tip, both)
        pull(one, tip, lambda answer: answer["holds"])  # two is silent


BAD = [
    (b"nonsense", "not msgpack"),
    (msgpack.packb({"v": 1, "position": [0, 0, float("nan")]}), "has nan in it"),
    (msgpack.packb({"v": 1, "cmd": "reset", "q": [0.0]}), "expected 2 numbers"),
    (msgpack.packb({"v": 1, "position": [0, 0, 0], "x": bytes(8000)}), "expected at most 4096"),
]


@pytest.mark.parametrize("kind", [zmq.REQ, zmq.DEALER], ids=["REQ", "DEALER"])
def test_bad_input_is_refused_and_survived(loop: TouchProcess, own_context, kind: int) -> None:
    for payload, said in BAD:
        with own_context.socket(kind) as socket:
            socket.linger = 0
            socket.connect(loop.haptic)
            socket.send(payload)
            assert socket.poll(1000 * PATIENCE_S)
            reply = msgpack.unpackb(socket.recv())
        assert reply.keys() == {"v", "error"}
        assert said in reply["error"]
    with own_context.socket(zmq.DEALER) as socket:
        socket.linger = 0
        socket.connect(loop.haptic)
        socket.send_multipart([b"a", b"b", b"c"])
        assert socket.poll(1000 * PATIENCE_S)
        assert "3 parts, expected 1" in msgpack.unpackb(socket.recv())["error"]
    with TouchDevice(own_context, loop.haptic) as device, pytest.raises(ProtocolError, match="has nan in it"):
        device.ask("reset", [float("nan"), 0.0])
    assert loop.alive


def test_frames_and_health_are_published(loop: TouchProcess, own_context) -> None:
    frames, health = [], None
    with Subscriber(own_context, loop.endpoint, [PLAY, HEALTH]) as subscriber:
        while health is None or len(frames) < 20:
            message = subscriber.receive(int(1000 * PATIENCE_S))
            assert message is not None
            topic, fields = message
            if topic == PLAY:
                frames.append(fields)
            else:
                health = fields
    frame = frames[-1]
    assert (frame["source"], frame["method"], frame["n"], frame["speed"]) == ("touch", "simulate", 1, 1.0)
    assert (frame["q"].shape, frame["tip"].shape, frame["points"].shape) == ((1, 2), (1, 3), (1, 4, 3))
    np.testing.assert_allclose(frame["tip"], tip_position(load_arm("dd-arm"), frame["q"]), atol=1e-12)
    assert np.diff([frame["frame0"] for frame in frames]).min() >= 1
    assert health.keys() >= {
        "held_rate_hz",
        "lateness_ms",
        "step_us",
        "overruns",
        "energy_J",
        "stale",
        "real_time",
    }
    assert health["lateness_ms"].keys() == {"p50", "p99", "max"}
    assert health["energy_J"].keys() >= {"stored", "dissipated", "injected", "passive"}


def test_hold_and_free(loop: TouchProcess, own_context) -> None:
    with TouchDevice(own_context, loop.haptic) as device:
        device.ask("reset", [0.3, 0.6])
        device.ask("hold", [0.5, 0.6])
        while abs(device.ask("state")["q"][0] - 0.3) < 0.01:
            pass
        device.ask("free")
        assert device.ask("reset", [0.1, 0.2])["q"] == [0.1, 0.2]


def test_what_cannot_start_says_why(loop: TouchProcess) -> None:
    arm = load_arm("dd-arm")
    with pytest.raises(DeviceError, match="is already taken"), TouchProcess(arm, haptic=loop.haptic):
        pass
    with pytest.raises(ConfigError, match="rate_hz is 7, expected 100 to 5000"):
        TouchProcess(arm, rate_hz=7.0)
    with pytest.raises(DataError, match="expected 2 finite numbers"):
        TouchProcess(arm, np.zeros(3))


def test_with_keys_only_whom_it_knows_is_heard(tmp_path: Path, own_context) -> None:
    file = new_client(tmp_path / "keys", "hand", tmp_path / "hand.limbkey")
    with TouchProcess(load_arm("dd-arm"), keys=tmp_path / "keys") as process:
        with TouchDevice(own_context, process.haptic, load_client_key(file)) as device:
            assert device.ask("state", timeout_ms=PATIENCE_MS)["q"] == [0.0, 0.0]
        with TouchDevice(own_context, process.haptic) as stranger, pytest.raises(DeviceError, match="no answer"):
            stranger.ask("state", timeout_ms=300)


ORPHAN = """
import sys
from arm.arm_file import load_arm
from playback.touch.process import TouchProcess
if __name__ == "__main__":
    process = TouchProcess(load_arm("dd-arm"))
    process.start()
    print(process.pid, flush=True)
    sys.stdin.read()
"""


def test_it_ends_when_its_parent_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "parent.py"
    script.write_text(ORPHAN, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.getcwd()}
    with subprocess.Popen(
        [sys.executable, str(script)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
    ) as parent:
        child = psutil.Process(int(parent.stdout.readline()))
        parent.send_signal(signal.SIGKILL)
        _, alive = psutil.wait_procs([child], timeout=PATIENCE_S)
        assert not alive
