"""A child's failures reach the supervisor as sentences, and its end is noticed."""

import os
import signal
from collections.abc import Callable
from multiprocessing import get_context
from typing import Any

import pytest

from daemon.acquisition.ring import ring_memory
from daemon.process.child_process import ChildProcess, crash, failure, wait_for_any
from daemon.process.control_line import Said
from limbcal.errors import DeviceError
from tests.patience import PATIENCE_S


def ended(work: str, *arguments: object) -> tuple[list[Said], ChildProcess]:
    child = ChildProcess(get_context("spawn"), "test", work, *arguments)
    said: list[Said] = []
    while (heard := child.said()) is not None:
        said += heard
        wait_for_any([child], [], PATIENCE_S)
    assert child.end(30.0)
    return said, child


def test_an_error_of_ours_arrives_as_it_was() -> None:
    said, child = ended("daemon.acquisition.reader:run_reader", bytearray(256), "/dev/no-such-port", 115200)
    child.close()
    (item,) = said
    error = failure(item)
    assert isinstance(error, DeviceError)
    assert str(error) == "port /dev/no-such-port does not exist, expected the serial port of the device"


def test_any_other_error_keeps_its_traceback() -> None:
    said, child = ended("daemon.acquisition.reader:run_reader", b"too short", "/dev/no-such-port", 115200)
    child.close()
    (item,) = said
    error = crash(child, item)
    assert "the test process failed: TypeError" in str(error)
    assert "Traceback" in error.__notes__[0]


def test_one_that_does_not_stop_is_killed(pty_device: Callable[..., Any]) -> None:
    memory = ring_memory(get_context("spawn"), 4096)
    child = ChildProcess(
        get_context("spawn"), "test", "daemon.acquisition.reader:run_reader", memory, pty_device(None).path, 115200
    )
    wait_for_any([child], [], PATIENCE_S)
    assert child.said() == [{"what": "ready"}]
    os.kill(child.pid, signal.SIGSTOP)
    assert not child.end(0.05)
    assert str(child.ended()) == "the test process ended with signal 9, expected it to go on"
    child.close()


@pytest.mark.parametrize(
    ("kind", "code"),
    [
        ("ConfigError", 2),
        ("DataError", 2),
        ("ProtocolError", 3),
        ("DeviceError", 3),
        ("OSError", 3),
        ("Strange", 3),
    ],
)
def test_failures_other_than_of_input_are_the_device_s(kind: str, code: int) -> None:
    assert failure({"what": "failed", "kind": kind, "sentence": "so"}).exit_code == code


@pytest.mark.parametrize("code", [0, 7])
def test_one_that_ends_without_a_word_is_named_with_its_exit_code(code: int) -> None:
    child = ChildProcess(get_context("spawn"), "test", "tests.daemon.process.test_child_process:leave", code)
    wait_for_any([child], [], PATIENCE_S)
    assert child.said() is None
    assert str(child.ended()) == f"the test process ended with exit code {code}, expected it to go on"
    assert child.end(30.0)
    child.close()


def leave(_line: object, code: int) -> None:
    """Be a child that ends in the middle of its work."""
    os._exit(code)
