"""What the haptic loop's parent makes of what is said over the pipe; the process only pretends to be one."""

import json
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
import pytest

import playback.touch.process as module
from arm.arm_file import load_arm
from limbcal.errors import ConfigError, DataError, DeviceError, ProtocolError
from playback.touch.limit import Coupling
from playback.touch.loop import Setup
from playback.touch.process import TouchProcess
from tests.patience import PATIENCE_S

ARM = load_arm("dd-arm")
BEGUN = {"endpoint": "tcp://127.0.0.1:1", "haptic": "tcp://127.0.0.1:2", "health": {"ticks": 0}}


class Child:
    """The process, and its end of the pipe."""

    def __init__(self) -> None:
        self.setup: Any = None
        self.name = ""
        self.pid: int | None = None
        self.lives = 1  # so often it is alive when asked, after a stop
        self.killed = 0
        self.joined: list[float] = []
        self.first: dict[str, object] = BEGUN
        self.line: Any = None
        self.stopped = False

    def Pipe(self) -> tuple[Connection, Connection]:  # noqa: N802 - as a context of multiprocessing has it
        return Pipe()

    def Process(self, target: object, args: tuple[Any, ...], name: str) -> "Child":  # noqa: N802 - likewise
        theirs, self.setup = args
        self._theirs, self.name = theirs, name
        return self

    def start(self) -> None:
        self.pid = 4711
        self.line = Connection(os.dup(self._theirs.fileno()))
        self.say(**self.first)

    def say(self, **fields: object) -> None:
        self.line.send_bytes(json.dumps(fields).encode())

    def heard(self) -> list[bytes]:
        found = []
        with suppress(EOFError):
            while self.line.poll():
                found.append(self.line.recv_bytes())
        return found

    def answer(self) -> None:
        """Answer one question, when it is asked."""
        assert self.line.recv_bytes() == b"health"
        self.say(health={"ticks": 77})

    def is_alive(self) -> bool:
        self.lives -= self.stopped
        return self.lives >= 0 and not self.killed

    def join(self, timeout_s: float) -> None:
        self.joined.append(timeout_s)

    def kill(self) -> None:
        self.killed += 1


@pytest.fixture
def child(monkeypatch: pytest.MonkeyPatch) -> Iterator[Child]:
    made = Child()
    monkeypatch.setattr(module, "get_context", lambda _: made)
    monkeypatch.setattr(module, "_STOP_S", 0.01)
    yield made
    if made.line is not None:
        made.line.close()


def closing(child: Child, process: TouchProcess) -> dict[str, Any]:
    child.stopped = True
    return process.close()


def test_before_it_is_started_it_is_nothing(child: Child) -> None:
    process = TouchProcess(ARM)
    assert (process.alive, process.pid, process.health(), process.close()) == (False, None, {}, {})
    assert (process.endpoint, process.haptic) == ("tcp://127.0.0.1:*", "tcp://127.0.0.1:*")


def test_the_loop_is_given_what_was_asked_for_and_says_where_it_is(child: Child) -> None:
    coupling = Coupling(stiffness=55.0)
    process = TouchProcess(ARM, np.array([0.1, 0.2]), 500.0, coupling, "tcp://127.0.0.1:5", "tcp://127.0.0.1:6")
    process.start()
    assert child.setup == Setup(ARM, (0.1, 0.2), 500.0, coupling, "tcp://127.0.0.1:5", "tcp://127.0.0.1:6", None)
    assert child.name == "limbplay-touch"
    assert (process.endpoint, process.haptic, process.pid) == ("tcp://127.0.0.1:1", "tcp://127.0.0.1:2", 4711)
    assert process.alive
    closing(child, process)


def test_unless_said_otherwise_it_runs_at_1_khz_from_zero(child: Child) -> None:
    process = TouchProcess(ARM)
    process.start()
    assert child.setup == Setup(
        ARM, (0.0, 0.0), 1000.0, Coupling(), "tcp://127.0.0.1:*", "tcp://127.0.0.1:*", None
    )
    closing(child, process)


def test_health_is_asked_for_once_until_it_comes(child: Child) -> None:
    process = TouchProcess(ARM)
    process.start()
    assert process.health() == process.health() == {"ticks": 0}
    assert child.heard() == [b"health"]
    child.say(health={"ticks": 20})
    assert process.health() == {"ticks": 20}
    assert child.heard() == [b"health"]
    closing(child, process)


def test_health_that_is_waited_for_is_the_next(child: Child) -> None:
    process = TouchProcess(ARM)
    process.start()
    for _ in range(2):  # it is asked for anew each time
        thread = threading.Thread(target=child.answer)
        thread.start()
        assert process.wait_health(PATIENCE_S) == {"ticks": 77}
        thread.join()
    with pytest.raises(DeviceError, match=r"^the haptic loop did not answer within 0\.01 s$"):
        process.wait_health(0.01)
    closing(child, process)


@pytest.mark.parametrize(
    ("failed", "kind"),
    [
        ("ConfigError", ConfigError),
        ("DataError", DataError),
        ("DeviceError", DeviceError),
        ("ProtocolError", ProtocolError),
        ("Unheard", DeviceError),
    ],
)
@pytest.mark.parametrize("trace", ["", "Traceback: here"])
def test_why_it_cannot_start_is_raised_here(child: Child, failed: str, kind: type[Exception], trace: str) -> None:
    child.first = {"failed": failed, "sentence": "no such luck", "trace": trace}
    child.stopped = True
    with pytest.raises(kind) as caught, TouchProcess(ARM):
        pass
    assert type(caught.value) is kind and str(caught.value) == "no such luck"
    assert getattr(caught.value, "__notes__", []) == ([trace] if trace else [])
    assert child.heard() == [b"stop"]


def test_its_last_health_is_what_closing_returns(child: Child) -> None:
    process = TouchProcess(ARM)
    process.start()
    child.say(health={"ticks": 99})
    assert closing(child, process) == {"ticks": 99}
    assert child.heard() == [b"stop"]
    assert (child.joined, child.killed) == ([0.01], 0)
    assert process.close() == process.health() == {"ticks": 99}  # harmless


def test_one_that_does_not_stop_is_killed(child: Child) -> None:
    process = TouchProcess(ARM)
    process.start()
    child.lives = 100
    assert closing(child, process) == {"ticks": 0}
    assert (child.joined, child.killed) == ([0.01, 0.01], 1)


@pytest.mark.parametrize("look", [TouchProcess.health, TouchProcess.wait_health])
def test_one_that_ended_by_itself_is_said(child: Child, look: Callable[[TouchProcess], object]) -> None:
    process = TouchProcess(ARM)
    process.start()
    child.line.close()
    with pytest.raises(DeviceError, match="ended by itself, expected it to go on"):
        look(process)
    closing(child, process)
