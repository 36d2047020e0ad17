"""A device that says what none may is refused with a sentence, or waited out, and never with exit code 2."""

import json
import threading
from collections.abc import Callable, Iterator
from dataclasses import asdict
from multiprocessing import get_context
from multiprocessing.connection import Pipe
from pathlib import Path
from typing import Any

import pytest

from daemon.acquisition import reader
from daemon.acquisition.ring import ring_memory
from daemon.process.child_process import failure
from daemon.process.control_line import ControlLine
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
    to = ("--arm", "dd-arm", "--method", "integrate", "--endpoint", f"ipc://{tmp_path}/f", "--json")
    daemon = limbd("run", "--wait", "--port", device.path, *to)
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


@pytest.fixture
def told_to_start(
    pty_device: MakeDevice, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[DeviceInfo | None], Any]]:
    """Read from a device that does not stream, fifty times as fast as in earnest."""
    monkeypatch.setattr(reader, "_SILENT_S", 0.01)
    monkeypatch.setattr(reader, "_LAST_NUDGE_S", 0.04)
    monkeypatch.setattr(reader, "_IDLE_S", 0.005)
    ours, theirs = Pipe()
    line, threads = ControlLine(ours), list[threading.Thread]()

    def reading(info: DeviceInfo | None) -> Any:
        device = pty_device(info)
        memory = ring_memory(get_context("spawn"), 65536)
        arguments = (ControlLine(theirs), memory, device.path, 115200)
        threads.append(threading.Thread(target=reader.run_reader, args=arguments))
        threads[0].start()
        line.tell("start")
        return device

    yield reading
    line.tell("stop")
    threads[0].join()
    ours.close()
    theirs.close()


def starts(device: Any) -> int:
    return int(device.commands.count(b"START\n"))


@pytest.mark.parametrize("info", [None, device_info()], ids=["says nothing", "says what it is"])
def test_one_that_does_not_stream_is_told_to_start_at_an_even_pace(
    told_to_start: Callable[[DeviceInfo | None], Any], info: DeviceInfo | None
) -> None:
    device = told_to_start(info)  # doubled without a cap, the fortieth would be sent after 17 years
    wait_until(lambda: starts(device) >= 40, "it got START forty times")


def test_one_that_falls_silent_again_and_again_is_told_as_often(
    told_to_start: Callable[[DeviceInfo | None], Any],
) -> None:
    device, before = told_to_start(None), 0
    for info in (device_info(), None, device_info(), None):
        before = starts(device)
        wait_until(lambda: starts(device) >= before + 15, "it got START fifteen times more")  # noqa: B023 - called at once
        device.introduce(info)


def test_nobody_is_left_alone_for_longer_than_two_seconds() -> None:
    assert 0.0 < reader._SILENT_S <= reader._LAST_NUDGE_S <= 2.0
