"""A device that says what none may is refused with a sentence, or waited out, and never with exit code 2."""

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

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


def test_what_no_device_may_say_is_a_sentence(limbd: Limbd, pty_device: MakeDevice, tmp_path: Path) -> None:
    device = pty_device(saying(serial="1\n<0>\x1b[2J"))
    daemon = limbd("run", "--port", device.path, "--arm", "dd-arm", "--endpoint", f"ipc://{tmp_path}/f", "--json")
    assert daemon.wait() == 3
    assert "INFO: serial is '1\\n<0>\\x1b[2J', expected only" in daemon.said and daemon.said.count("error:") == 1
    assert "Traceback" not in daemon.said and "\x1b" not in daemon.said


def test_where_a_device_is_waited_for_the_next_one_is_taken_up(
    limbd: Limbd, pty_device: MakeDevice, tmp_path: Path
) -> None:
    others = {
        "the device's channels are x y, expected the sensors of arm 'dd-arm'": device_info(names=["x", "y"]),
        "device is '\\ud800', expected only characters that can be printed": saying(device="\ud800"),
        "tick_hz is 0, expected a number of 0.1 to 1e+12": saying(tick_hz=0),
    }
    device = pty_device(None)
    to = ("--arm", "dd-arm", "--method", "integrate", "--endpoint", f"ipc://{tmp_path}/f", "--json")
    daemon = limbd("run", "--wait", "--port", device.path, *to)
    for said, info in others.items():
        device.introduce(info)
        wait_until(lambda said=said: said in daemon.said, said)  # type: ignore[misc]
    assert daemon.said.count("; waiting for it") >= len(others)
    assert "Traceback" not in daemon.said and "error:" not in daemon.said
    device.introduce(device_info())
    assert daemon.announcement()["device"] == "test device"
    assert daemon.stop() == 0
