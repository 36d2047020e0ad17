"""The process of the haptic loop from within, in the test's own process: what it tells its parent."""

import gc
import json
import signal
from collections.abc import Iterator
from dataclasses import replace
from multiprocessing import Pipe
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from playback.touch.limit import Coupling
from playback.touch.loop import Setup
from playback.touch.loop_process import be_loop, warmed_up

SETUP = Setup(load_arm("dd-arm"), (0.3, 0.6), 1000.0)


@pytest.fixture(autouse=True)
def _own_signals() -> Iterator[None]:
    """Undo what concerns the whole process."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)
    gc.unfreeze()


def answers(setup: Setup, *orders: bytes) -> list[dict[str, Any]]:
    """Return what the loop tells a parent that has said all its orders already."""
    parent, child = Pipe()
    with parent:
        for order in orders:
            parent.send_bytes(order)
        be_loop(child, setup)
        assert child.closed
        said = []
        while parent.poll():
            try:
                said.append(json.loads(parent.recv_bytes()))
            except EOFError:
                break
    return said


def test_it_says_where_it_is_reached_and_how_it_goes_until_told_to_stop() -> None:
    begun, asked, ended = answers(SETUP, b"health", b"stop")
    assert begun["endpoint"].startswith("tcp://127.0.0.1:") and begun["haptic"].startswith("tcp://127.0.0.1:")
    assert [one["health"]["ticks"] for one in (begun, asked, ended)] == [0, 20, 40]  # it looks every 20 ms
    assert begun["health"]["rate_hz"] == 1000.0
    assert gc.isenabled()
    assert signal.getsignal(signal.SIGINT) == signal.getsignal(signal.SIGTERM) == signal.SIG_IGN


def test_an_arm_without_masses_is_the_input_s_fault() -> None:
    (said,) = answers(replace(SETUP, arm=Arm("hollow", (Joint(a_m=0.3), Joint(a_m=0.2)))))
    assert (said["failed"], said["trace"]) == ("DataError", "")
    assert said["sentence"].startswith("arm 'hollow' runs away to infinity at once: expected masses")


def test_at_a_low_rate_it_looks_every_tick() -> None:
    said = answers(replace(SETUP, rate_hz=20.0), b"health", b"stop")
    assert [one["health"]["ticks"] for one in said] == [0, 1, 2]


@pytest.mark.parametrize(
    ("change", "failed", "sentence", "traced"),
    [
        ({"endpoint": "nowhere"}, "ConfigError", "nowhere", False),
        ({"q0": (0.0,)}, "DataError", "expected 2 finite numbers", False),
        ({"rate_hz": 0.0}, "DeviceError", "the haptic loop failed: ZeroDivisionError: ", True),
    ],
)
def test_what_went_wrong_is_said(change: dict[str, Any], failed: str, sentence: str, traced: bool) -> None:
    (said,) = answers(replace(SETUP, **change))
    assert said["failed"] == failed and sentence in said["sentence"]
    assert ("Traceback" in said["trace"]) == traced


class Line:
    """A pipe that breaks when the loop looks at it."""

    def __init__(self, error: Exception) -> None:
        self.said: list[dict[str, Any]] = []
        self.closed = 0
        self._error = error

    def send_bytes(self, said: bytes) -> None:
        self.said.append(json.loads(said))

    def poll(self) -> bool:
        raise self._error

    def close(self) -> None:
        self.closed += 1


@pytest.mark.parametrize("error", [EOFError(), BrokenPipeError(), ConnectionResetError()])
def test_a_parent_that_is_gone_is_told_nothing(error: Exception) -> None:
    line = Line(error)
    be_loop(line, SETUP)  # type: ignore[arg-type]
    assert len(line.said) == 1 and line.closed == 1


def test_an_error_of_the_system_is_said() -> None:
    line = Line(OSError("no such luck"))
    be_loop(line, SETUP)  # type: ignore[arg-type]
    assert line.said[1]["failed"] == "DeviceError"
    assert line.said[1]["sentence"] == "the haptic loop failed: no such luck"
    assert "Traceback" in line.said[1]["trace"]


def test_an_arm_that_was_warmed_up_rests_where_it_is_to_begin() -> None:
    arm = warmed_up(replace(SETUP, rate_hz=500.0, coupling=Coupling(stiffness=77.0)))
    assert arm.state.tolist() == [[0.3, 0.6], [0.0, 0.0], [0.0, 0.0]]
    assert (arm.step_s, arm.asked.stiffness) == (0.002, 77.0)
    arm.step(1)
    assert not arm.felt.any()
    np.testing.assert_allclose(arm.state[0], [0.3, 0.6], rtol=0, atol=1e-9)
