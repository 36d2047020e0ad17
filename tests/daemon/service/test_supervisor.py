"""How processes are started, asked and stopped, and who is to blame: with children that the test speaks for."""

from collections.abc import Iterator
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

from daemon.config.config import Setup, load_setup
from daemon.process.child_process import ChildProcess
from daemon.process.control_line import ControlLine
from daemon.process.stop_signal import StopSignal
from daemon.service import supervisor as module
from daemon.service.supervisor import Supervisor
from limbcal.errors import ConfigError, DeviceError

#: What each says as soon as it is started; the rest when it is asked to.
SAYS: dict[str, list[dict[str, Any]]] = {
    "reader": [{"what": "ready"}],
    "recorder": [{"what": "ready"}, {"what": "linked"}],
    "pipeline": [
        {"what": "ready", "endpoint": "tcp://127.0.0.1:7"},
        {"what": "heard"},
        {"what": "tracking", "rate_hz": 8000.0, "device": "a device"},
    ],
    "replay": [{"what": "ready", "port": "/dev/pts/77"}],
}


class Actor(ChildProcess):
    """A child that says its part, and notes what it is sent."""

    def __init__(self, name: str, *arguments: Any, says: list[dict[str, Any]] | None = None) -> None:
        self.name, self.arguments, self.willing = name, arguments, True
        self.last: list[dict[str, Any]] = []
        ours, theirs = get_context("spawn").Pipe()
        self.line, self.voice = ControlLine(ours), ControlLine(theirs)
        for one in SAYS[name] if says is None else says:
            self.says(**one)

    @property
    def pid(self) -> int:
        return 1000 + len(self.name)

    def says(self, what: str, **fields: Any) -> None:
        self.voice.tell(what, **fields)

    def heard(self) -> list[str]:
        found = []
        while (said := self.voice.hear()) is not None:
            found.append(said["what"])
        return found

    def end(self, timeout_s: float) -> bool:
        self.patience_s = timeout_s
        for one in self.last:
            self.says(**one)
        return self.willing

    def ended(self) -> DeviceError:
        return DeviceError(f"{self.name} ended")

    def close(self) -> None:
        pass

    def bury(self) -> None:
        self.line.close()
        self.voice.close()


class Stage:
    """A supervisor, its children as they were started, and what it said."""

    def __init__(self, stop: StopSignal) -> None:
        self.stop = stop
        self.children: list[Actor] = []
        self.started: list[dict[str, Any]] = []
        self.health: list[dict[str, Any]] = []
        self.trouble: list[str] = []

    def child(self, _context: object, name: str, _work: str, *arguments: Any) -> Actor:
        self.children.append(Actor(name, *arguments))
        return self.children[-1]

    def named(self, name: str) -> Actor:
        return next(one for one in self.children if one.name == name)

    def supervisor(self, setup: Setup, wait: bool = False) -> Supervisor:
        return Supervisor(
            setup,
            self.stop,
            lambda said: self.started.append(dict(said)),
            lambda said: self.health.append(dict(said)),
            self.trouble.append,
            wait,
        )

    def with_children(self, *names: str) -> Supervisor:
        """Return a supervisor whose children have not said anything."""
        made = self.supervisor(setup_of())
        self.children += [Actor(name, says=[]) for name in names]
        made._children = {one.name: one for one in self.children}
        return made


def setup_of(**tables: Any) -> Setup:
    return load_setup(None, {"device": {"port": "/dev/ttyX", "baud": 9600}, "arm": {"file": "dd-arm"}, **tables})


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Iterator[Stage]:
    with StopSignal() as stop:
        made = Stage(stop)
        monkeypatch.setattr(module, "ChildProcess", made.child)
        yield made
        for one in made.children:
            one.bury()


def test_a_run_without_a_recording_has_a_reader_and_a_pipeline(stage: Stage) -> None:
    supervisor = stage.supervisor(setup_of(), wait=True)
    supervisor._start()
    reader, pipeline = stage.children
    assert (reader.name, reader.arguments[1:]) == ("reader", ("/dev/ttyX", 9600, True, True))
    assert len(reader.arguments[0]) == 32 * 1024 * 1024 + 64
    assert pipeline.arguments[0] is reader.arguments[0] and pipeline.arguments[3:] == (None, "")
    assert reader.heard() == ["start"]  # the device had said already what it is
    assert pipeline.voice.hear() == {"what": "handshake", "wait": True}
    (announced,) = stage.started
    assert announced | {"run": ""} == {
        "run": "",
        "arm": "dd-arm",
        "port": "/dev/ttyX",
        "device": "a device",
        "rate_hz": 8000.0,
        "endpoint": "tcp://127.0.0.1:7",
        "recording": None,
        "processes": {"reader": 1006, "pipeline": 1008},
    }
    assert len(announced["run"]) == 36


def test_a_recording_gets_its_limits_and_a_room_of_its_own(stage: Stage, tmp_path: Path) -> None:
    record = {"directory": str(tmp_path), "file_mb": 5.0, "file_minutes": 2.0, "free_mb": 7.0}
    supervisor = stage.supervisor(setup_of(record=record))
    supervisor._start()
    recorder, pipeline = stage.named("recorder"), stage.named("pipeline")
    endpoint, recording, arm_text, config_text, limits = recorder.arguments
    assert pipeline.arguments[3:] == (endpoint, recording)
    assert (limits.file_bytes, limits.file_s, limits.free_bytes) == (5_000_000, 120.0, 7_000_000)
    run = stage.started[0]["run"]
    assert stage.started[0]["recording"] == recording and Path(recording).parent == tmp_path
    assert Path(recording).name.startswith("dd-arm-2") and recording.endswith(f"Z-{run[:8]}.mcap")
    assert "dd-arm" in arm_text and "file_mb = 5.0" in config_text
    room = Path(endpoint.removeprefix("ipc://"))
    assert room.name == "recorder" and not room.parent.exists()  # both ends are there
    assert [one.name for one in stage.children] == ["reader", "recorder", "pipeline"]


def test_a_replay_s_port_is_the_one_that_its_process_made(stage: Stage, tmp_path: Path) -> None:
    supervisor = stage.supervisor(replace(setup_of(), replay=tmp_path / "a.mcap", speed=3.0))
    supervisor._start()
    assert [one.name for one in stage.children] == ["replay", "reader", "pipeline"]
    assert stage.named("replay").arguments == (str(tmp_path / "a.mcap"), 3.0)
    assert stage.named("reader").arguments[1] == stage.started[0]["port"] == "/dev/pts/77"


@pytest.mark.parametrize(("there", "advised"), [(False, True), (True, False)])
def test_waiting_is_advised_where_there_is_no_port(
    stage: Stage, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, there: bool, advised: bool
) -> None:
    port = tmp_path / "port"
    if there:
        port.touch()
    monkeypatch.setitem(SAYS, "reader", [{"what": "failed", "kind": "DeviceError", "sentence": "no port"}])
    supervisor = stage.supervisor(setup_of(device={"port": str(port)}))
    with pytest.raises(DeviceError) as caught:
        supervisor._start()
    assert str(caught.value) == ("no port; `limbd run --wait` waits for it" if advised else "no port")
    assert len(stage.children) == 1


def test_a_device_is_asked_until_it_is_heard(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    supervisor = stage.with_children("reader", "pipeline")
    now_s, reader, pipeline = [0.0], stage.named("reader"), stage.named("pipeline")
    listens: list[float] = []

    def listen() -> None:
        listens.append(now_s[0])
        now_s[0] += 0.5
        if now_s[0] == 2.5:
            supervisor._note(pipeline, {"what": "heard"})
            supervisor._note(pipeline, {"what": "tracking", "rate_hz": 1.0, "device": "d"})

    monkeypatch.setattr(module.time, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(supervisor, "_listen", listen)
    assert supervisor._introduce()["device"] == "d"
    assert reader.heard() == ["ask", "ask", "ask"]  # at 0, 1 and 2 s
    assert listens == [0.0, 0.5, 1.0, 1.5, 2.0]


def test_what_children_say_is_passed_on(stage: Stage) -> None:
    supervisor = stage.with_children("reader", "pipeline", "recorder")
    reader, pipeline, recorder = stage.children
    waiting = {"what": "waiting", "sentence": "port x: gone"}
    for _ in range(2):
        supervisor._note(reader, waiting)
    assert stage.trouble == ["port x: gone; waiting for it"]  # the same is said once
    supervisor._note(pipeline, {"what": "reopened"})
    supervisor._note(reader, waiting)
    supervisor._note(recorder, {"what": "disk-failed", "sentence": "full"})
    supervisor._note(recorder, {"what": "disk-failed", "sentence": "full"})
    supervisor._note(recorder, {"what": "recording", "path": "b.mcap"})
    assert stage.trouble[1:] == ["port x: gone; waiting for it", "full", "recording to b.mcap"]
    supervisor._note(pipeline, {"what": "health", "words": ["alarm: a", "over: b"]})
    assert stage.trouble[4:] == ["alarm: a", "over: b"] and len(stage.health) == 1
    supervisor._note(pipeline, {"what": "ask"})
    assert reader.heard() == ["ask"]
    with pytest.raises(ConfigError, match="wrong"):
        supervisor._note(pipeline, {"what": "failed", "kind": "ConfigError", "sentence": "wrong"})


def test_a_replay_that_was_played_ends_the_run(stage: Stage) -> None:
    supervisor = stage.with_children("replay")
    supervisor._listen = lambda: stage.named("replay").says("played") or Supervisor._listen(supervisor)  # type: ignore
    supervisor._start = lambda: None  # type: ignore[method-assign]
    supervisor.run()
    assert stage.named("replay").patience_s == 5.0


def test_processes_are_stopped_in_the_order_in_which_data_flows(stage: Stage) -> None:
    supervisor = stage.with_children("replay", "recorder", "pipeline", "reader")
    order: list[str] = []
    for one in stage.children:
        one.last = [{"what": "recording", "path": one.name}]
    supervisor._on_trouble = order.append
    assert supervisor._shut_down() is None
    assert order == [f"recording to {name}" for name in ("reader", "pipeline", "recorder", "replay")]
    assert [one.patience_s for one in stage.children] == [5.0, 60.0, 30.0, 5.0]


def test_what_goes_wrong_first_in_stopping_is_said(stage: Stage) -> None:
    supervisor = stage.with_children("reader", "pipeline")
    stage.named("reader").willing = False
    stage.named("pipeline").last = [{"what": "failed", "kind": "DeviceError", "sentence": "later"}]
    trouble = supervisor._shut_down()
    assert str(trouble) == "the reader process did not stop within 5 s: killed"
    stage.named("reader").willing = True
    again = supervisor._shut_down()
    assert str(again) == "later"


def test_what_ended_a_run_is_said_rather_than_what_goes_wrong_afterwards(stage: Stage) -> None:
    supervisor = stage.with_children("reader", "pipeline")
    stage.named("reader").willing = False
    stage.named("pipeline").says("failed", kind="DeviceError", sentence="the first")
    supervisor._start = lambda: None  # type: ignore[method-assign]
    with pytest.raises(DeviceError, match="the first"):
        supervisor.run()


def test_a_recorder_that_closed_its_file_leaves_the_word_to_the_pipeline(stage: Stage) -> None:
    supervisor = stage.with_children("recorder", "pipeline")
    stage.named("recorder").says("closed", messages=0)
    stage.named("recorder").voice.close()
    supervisor._listen()
    supervisor._listen()
    stage.named("pipeline").says("failed", kind="DeviceError", sentence="no valid frame")
    with pytest.raises(DeviceError, match="no valid frame"):
        supervisor._listen()


def test_a_recorder_that_ends_before_its_file_is_closed_is_to_blame(stage: Stage) -> None:
    supervisor = stage.with_children("recorder")
    stage.named("recorder").voice.close()
    with pytest.raises(DeviceError, match="recorder ended"):
        supervisor._listen()


@pytest.mark.parametrize(("lost", "said"), [(0, "None"), (3, "the recording is incomplete: no room")])
def test_what_the_recorder_could_not_write_is_said_at_the_end(stage: Stage, lost: int, said: str) -> None:
    supervisor = stage.with_children("recorder")
    for one in ({"what": "disk-failed", "sentence": "no room"}, {"what": "closed", "lost": lost}):
        supervisor._note(stage.named("recorder"), one)
    assert str(supervisor._shut_down()) == said
