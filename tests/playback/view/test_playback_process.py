"""How a page waits for the playback beside it, and what it says of one that does not come up."""

import argparse
import os
import signal
from collections.abc import Callable, Iterator
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import playback.view.playback_process as module
from limbcal.errors import ConfigError, DataError, DeviceError
from playback.control_message import Request
from playback.view.playback_process import PlaybackProcess

ARGUMENTS = argparse.Namespace(source="x.npz", endpoint="tcp://127.0.0.1:5772", control="tcp://127.0.0.1:5773")
CONTEXT: Any = "the context"


class World:
    """A process that follows a script, a clock, and what is asked of the playback."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.pid: int | None = None
        self.dies_by = "terminate"
        self.alive = False
        self.exitcode = 3
        self.log: list[str] = []
        self.asked: list[tuple[Any, ...]] = []
        self.answers: Callable[[int], Exception | None] = lambda _: None
        self.given: dict[str, Any] = {}
        self.pipe: Connection | None = None
        self.at_start: Callable[[World], None] = lambda _: None

    # a context of multiprocessing
    def Pipe(self, duplex: bool) -> tuple[Connection, Connection]:  # noqa: N802 - as it is called there
        assert duplex is False
        return Pipe(duplex=False)

    def Process(self, target: object, args: tuple[Any, ...], name: str) -> "World":  # noqa: N802 - likewise
        self.given, theirs = args
        self._theirs = theirs
        return self

    # its process
    def start(self) -> None:
        self.pid, self.alive = 4711, True
        self.pipe = Connection(os.dup(self._theirs.fileno()), readable=False)
        self.at_start(self)

    def is_alive(self) -> bool:
        return self.alive

    def join(self, timeout_s: float | None = None) -> None:
        self.log.append(f"join {timeout_s}")

    def terminate(self) -> None:
        self._end("terminate")

    def kill(self) -> None:
        self._end("kill")

    def _end(self, how: str) -> None:
        self.log.append(how)
        self.alive = self.alive and self.dies_by != how

    def ask(self, *what: object) -> None:
        self.asked.append(what)
        self.now_s += 0.2
        if (error := self.answers(len(self.asked))) is not None:
            raise error


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[World]:
    made = World()
    monkeypatch.setattr(module.multiprocessing, "get_context", lambda _: made)
    monkeypatch.setattr(module.tempfile, "mkdtemp", lambda prefix: str(_made(tmp_path / f"{prefix}1")))
    monkeypatch.setattr(module, "ask", made.ask)
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: made.now_s))
    yield made
    if made.pipe is not None:
        made.pipe.close()


def _made(path: Path) -> Path:
    path.mkdir()
    return path


def test_it_serves_in_a_folder_of_its_own_until_it_is_closed(world: World, tmp_path: Path) -> None:
    folder = tmp_path / "limbplay-1"
    with PlaybackProcess(CONTEXT, ARGUMENTS) as one:
        assert (one.endpoint, one.control) == (f"ipc://{folder}/play", f"ipc://{folder}/control")
        assert world.given == {"source": "x.npz", "endpoint": one.endpoint, "control": one.control}
        assert one.alive() and folder.is_dir()
        assert world.asked == [(CONTEXT, one.control, Request("state"), 200)]
        assert world.log == []
    assert world.log == ["terminate", "join 5.0"]
    assert not one.alive() and not folder.exists()
    one.close()  # harmless


def test_one_that_does_not_end_is_killed(world: World) -> None:
    world.dies_by = "kill"
    PlaybackProcess(CONTEXT, ARGUMENTS).close()
    assert world.log == ["terminate", "join 5.0", "kill", "join None"]


def test_it_is_asked_until_it_answers(world: World) -> None:
    world.answers = lambda n: DeviceError("no answer") if n < 400 else None
    PlaybackProcess(CONTEXT, ARGUMENTS).close()
    assert len(world.asked) == 400


@pytest.mark.parametrize("error", [ConfigError(["one", "two"]), DataError("no such file")])
def test_why_it_cannot_serve_is_raised_here(world: World, tmp_path: Path, error: Exception) -> None:
    def say(here: World) -> None:
        assert here.pipe is not None
        here.pipe.send(error)

    world.at_start = say
    with pytest.raises(type(error)) as caught:
        PlaybackProcess(CONTEXT, ARGUMENTS)
    assert str(caught.value) == str(error)
    assert world.log[0] == "terminate" and not list(tmp_path.iterdir()) and not world.asked


def test_one_that_ends_without_a_word_is_said_with_its_code(world: World, tmp_path: Path) -> None:
    def end(here: World) -> None:
        assert here.pipe is not None
        here.pipe.close()
        here.alive = False

    world.at_start = end
    with pytest.raises(DeviceError, match="^the playback's process ended with code 3$"):
        PlaybackProcess(CONTEXT, ARGUMENTS)
    assert world.log[0] == "join 5.0" and not list(tmp_path.iterdir())


def test_one_that_was_killed_is_not_waited_for(world: World) -> None:
    world.at_start = lambda here: setattr(here, "alive", False)
    world.answers = lambda _: DeviceError("no answer from ipc")
    with pytest.raises(DeviceError, match="no answer from ipc"):
        PlaybackProcess(CONTEXT, ARGUMENTS)
    assert len(world.asked) == 1


def test_after_two_minutes_it_is_given_up(world: World) -> None:
    world.answers = lambda _: DeviceError("no answer")
    with pytest.raises(DeviceError, match="^the playback's process does not answer within 120 s$"):
        PlaybackProcess(CONTEXT, ARGUMENTS)
    assert world.now_s == pytest.approx(120.0, abs=0.21)


@pytest.mark.parametrize("error", [None, ConfigError(["a", "b"]), DataError("none"), KeyError("x")])
def test_within_the_process_an_error_of_ours_goes_to_the_page(
    monkeypatch: pytest.MonkeyPatch, error: Exception | None
) -> None:
    served: list[argparse.Namespace] = []

    def serve(arguments: argparse.Namespace) -> None:
        served.append(arguments)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        with pytest.raises(SystemExit):
            signal.raise_signal(signal.SIGTERM)
        if error is not None:
            raise error

    monkeypatch.setattr(module.serve, "serve", serve)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    ours, theirs = Pipe(duplex=False)
    try:
        if isinstance(error, KeyError):  # no error of ours: its traceback is what is wanted
            with pytest.raises(KeyError):
                module._serve({"source": "x"}, theirs)
        else:
            module._serve({"source": "x"}, theirs)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert served == [argparse.Namespace(source="x")] and theirs.closed
    with ours:
        if error is not None and not isinstance(error, KeyError):
            said = ours.recv()
            assert type(said) is type(error) and str(said) == str(error)
        with pytest.raises(EOFError):
            ours.recv()
