"""A device that says what none may is refused with a sentence, or waited out, and never with exit code 2."""

import json
import threading
from collections.abc import Callable
from dataclasses import asdict
from multiprocessing import get_context
from multiprocessing.connection import Pipe
from pathlib import Path
from typing import Any

import pytest

from daemon import reader
from daemon.child import failure
from daemon.control_line import ControlLine
from daemon.ring import ring_memory
from limbcal.errors import ConfigError, DataError, DeviceError, ProtocolError
from protocol.device_info import DeviceInfo
from tests.daemon.conftest import device_info, wait_until

MakeDevice = Callable[..., Any]
Limbd = Callable[..., Any]


class Saying(DeviceInfo):
    """An INFO with fields that no honest device would send."""

    fields: dict[str, object] = {}

    def to_json(self) -> bytes:
        return json.dumps({**asdict(self), **self.fields}).encode()


def saying(**fields: object) -> Saying:
    info = Saying(**{name: getattr(device_info(), name) for name in DeviceInfo.__dataclass_fields__})
    object.__setattr__(info, "fields", fields)
    return info


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"device": "\ud800"}, "INFO: device is '\\ud800', expected only characters that can be printed"),
        ({"serial": "1\n<0>\x1b[2J"}, "INFO: serial is '1\\n<0>\\x1b[2J', expected only"),
    ],
)
def test_what_no_device_may_say_is_a_sentence(
    limbd: Limbd, pty_device: MakeDevice, tmp_path: Path, fields: dict[str, object], said: str
) -> None:
    device = pty_device(saying(**fields))
    daemon = limbd("run", "--port", device.path, "--arm", "dd-arm", "--endpoint", f"ipc://{tmp_path}/f", "--json")
    assert daemon.wait() == 3
    assert said in daemon.said and daemon.said.count("error:") == 1
    assert "Traceback" not in daemon.said and "\x1b" not in daemon.said


@pytest.mark.parametrize(
    ("first", "said"),
    [
        (saying(device="\ud800"), "device is '\\ud800'"),
        (saying(tick_hz=0), "tick_hz is 0, expected a number of 0.1 to 1e+12"),
        (device_info(names=["x", "y"]), "the device's channels are x y, expected the sensors of arm 'dd-arm'"),
    ],
)
def test_where_a_device_is_waited_for_the_next_one_is_taken_up(
    limbd: Limbd, pty_device: MakeDevice, tmp_path: Path, first: DeviceInfo, said: str
) -> None:
    device = pty_device(first)
    arguments = ("--port", device.path, "--arm", "dd-arm", "--endpoint", f"ipc://{tmp_path}/f", "--json")
    daemon = limbd("run", "--wait", *arguments)
    wait_until(lambda: "; waiting for it" in daemon.said, "it says that it waits")
    assert said in daemon.said
    device.introduce(device_info())
    assert daemon.announcement()["device"] == "test device"
    assert daemon.stop() == 0


@pytest.mark.parametrize(
    ("kind", "found"), [(ConfigError, 2), (DataError, 2), (ProtocolError, 3), (DeviceError, 3), (OSError, 3)]
)
def test_only_a_config_or_what_is_replayed_ends_with_what_is_not_tried_again(
    kind: type[Exception], found: int
) -> None:
    assert failure({"what": "failed", "kind": kind.__name__, "sentence": "so"}).exit_code == found


def test_a_silent_device_is_told_to_start_at_an_even_pace(
    pty_device: MakeDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reader, "_SILENT_S", 0.01)
    monkeypatch.setattr(reader, "_LAST_NUDGE_S", 0.04)
    monkeypatch.setattr(reader, "_IDLE_S", 0.005)
    device, (ours, theirs) = pty_device(None), Pipe()
    memory = ring_memory(get_context("spawn"), 4096)
    thread = threading.Thread(target=reader.run_reader, args=(ControlLine(theirs), memory, device.path, 115200))
    thread.start()
    line = ControlLine(ours)
    line.tell("start")
    try:  # doubled without a cap, the fortieth would be sent after 17 years
        wait_until(lambda: device.commands.count(b"START\n") >= 40, "it was told forty times", 10.0)
    finally:
        line.tell("stop")
        thread.join()
        ours.close()
        theirs.close()
