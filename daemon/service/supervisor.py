"""Starts the processes of the daemon in order, watches them, and stops them with nothing lost or left."""

import shutil
import tempfile
import time
import uuid
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from multiprocessing import get_context
from multiprocessing.context import SpawnContext
from pathlib import Path
from typing import Any

from arm.arm_file import format_arm
from daemon.acquisition.ring import ring_memory
from daemon.config.config import WAIT_ADVICE, Setup, format_config
from daemon.process.child_process import ChildProcess, raise_failure, wait_for_any
from daemon.process.control_line import Said
from daemon.process.stop_signal import StopSignal
from daemon.recording.segments import Limits
from daemon.service.service_state import ServiceState
from limbcal.errors import DeviceError, LimbcalError
from limbcal.notify import notify

#: Bytes of the ring: 40 s of twelve channels at 32 kHz.
_RING_BYTES = 32 * 1024 * 1024
#: A device is asked this often what it is, until it says so [s].
_ASK_S = 1.0
#: How long one waits at a time for a child's word [s].
_WAIT_S = 0.5
#: How long each may take to stop: the reader drains the tty, the pipeline the ring, the recorder the disk.
_PATIENCE_S = {"reader": 5.0, "pipeline": 30.0, "recorder": 60.0, "replay": 5.0}

#: Called with what the daemon announces when it begins, and with its health once a second.
Listener = Callable[[Mapping[str, Any]], None]


class _StopRequested(Exception):  # noqa: N818 - not an error
    """A signal came, or a replay has ended."""


class Supervisor:
    """One run of the daemon.

    Parameters
    ----------
    setup : Setup
    stop : StopSignal
    on_start, on_health, on_trouble : callable
        Called with what began, how it goes, and what went wrong without ending the run.
    wait : bool
        Whether a device that is not there at the start is waited for.
    """

    def __init__(
        self,
        setup: Setup,
        stop: StopSignal,
        on_start: Listener,
        on_health: Listener,
        on_trouble: Callable[[str], None],
        wait: bool = False,
    ) -> None:
        self._setup = setup
        self._stop = stop
        self._on_start = on_start
        self._on_health = on_health
        self._on_trouble = on_trouble
        self._wait = wait
        self._run = str(uuid.uuid4())
        self._children: dict[str, ChildProcess] = {}
        self._heard: dict[tuple[str, str], Said] = {}
        self._done: set[str] = set()
        self._rooms: list[str] = []
        self._said = ""
        self._service = ServiceState(setup.config.device.port)
        self._played = False

    def run(self) -> None:
        """Run until a stop is asked for.

        Raises
        ------
        LimbcalError
            If a process failed, after all others were stopped; or if the recording is incomplete.
        """
        trouble: LimbcalError | None = None
        try:
            self._start()
            while True:
                self._listen()
        except _StopRequested:
            pass
        except LimbcalError as error:
            trouble = error
        finally:
            shutdown_trouble = self._shut_down()
        if trouble := trouble or shutdown_trouble:
            raise trouble

    def _start(self) -> None:
        context = get_context("spawn")
        config = self._setup.config
        memory = ring_memory(context, _RING_BYTES)
        port = self._port(context)
        # The port first: it fails most often, and the others need a second to start.
        self._children["reader"] = ChildProcess(
            context,
            "reader",
            "daemon.acquisition.reader:run_reader",
            *(memory, port, config.device.baud, self._wait, config.device.real_time),
        )
        self._until_opened(port)
        recorder, recording = None, ""
        if config.record is not None:
            recorder, recording = self._room(), self._recording_path(config.record.directory)
            texts = (format_arm(self._setup.arm), format_config(config))
            table = config.record
            limits = Limits(table.file_bytes, table.file_s, table.free_bytes)
            self._children["recorder"] = ChildProcess(
                context, "recorder", "daemon.recording.recorder:run_recorder", recorder, recording, *texts, limits
            )
        self._children["pipeline"] = ChildProcess(
            context,
            "pipeline",
            "daemon.pipeline.pipeline_process:run_pipeline",
            *(memory, self._setup, self._run, recorder, recording),
        )
        if config.record is not None:
            self._until("recorder", "ready")
        endpoint = self._until("pipeline", "ready")["endpoint"]
        if config.record is not None:
            self._until("recorder", "linked")
            self._clear_rooms()
        device = self._introduce()
        self._children["reader"].line.tell("start")
        self._on_start(
            {
                "run": self._run,
                "arm": self._setup.arm.name,
                "port": port,
                "device": device["device"],
                "rate_hz": device["rate_hz"],
                "endpoint": endpoint,
                "recording": recording or None,
                "processes": {name: child.pid for name, child in self._children.items()},
            }
        )

    def _port(self, context: SpawnContext) -> str:
        """Return the port to read from; where a recording is replayed, have a process be the device there."""
        replay = self._setup.replay
        if replay is None:
            return self._setup.config.device.port
        device = ChildProcess(
            context, "replay", "daemon.replay.replay_process:run_replay", str(replay), self._setup.speed
        )
        self._children["replay"] = device
        port: str = self._until("replay", "ready")["port"]
        return port

    def _until_opened(self, port: str) -> None:
        try:
            self._until("reader", "ready")
        except DeviceError as error:
            if Path(port).exists():
                raise
            raise DeviceError(f"{error}; {WAIT_ADVICE}") from error

    def _introduce(self) -> Said:
        """Ask the device for its INFO until it is heard; the pipeline says when that takes too long."""
        self._children["pipeline"].line.tell("handshake", wait=self._wait)
        while ("pipeline", "heard") not in self._heard:
            self._children["reader"].line.tell("ask")
            asked_s = time.monotonic()
            while ("pipeline", "heard") not in self._heard and time.monotonic() < asked_s + _ASK_S:
                self._listen()
        return self._until("pipeline", "tracking")

    def _until(self, name: str, what: str) -> Said:
        while (name, what) not in self._heard:
            self._listen()
        return self._heard[name, what]

    def _listen(self) -> None:
        if self._stop.came or self._played:
            raise _StopRequested
        heeded = [child for name, child in self._children.items() if name not in self._done]
        wait_for_any(heeded, [self._stop], _WAIT_S)
        for child in heeded:
            said = child.said()
            if said is None and (child.name, "closed") not in self._heard:
                raise child.ended()
            if said is None:  # the recorder closed its file because the pipeline ends, which is about to say why
                self._done.add(child.name)
            for item in said or []:
                self._note(child, item)

    def _note(self, child: ChildProcess, said: Said) -> None:
        what = said["what"]
        self._heard[child.name, what] = said
        raise_failure(child, said)
        self._service.hear(said)
        if what == "health":
            self._on_health(said)
            for sentence in said["words"]:
                self._on_trouble(sentence)
        elif what == "waiting":
            self._tell_once(f"{said['sentence']}; waiting for it")
        elif what == "disk-failed":
            self._tell_once(said["sentence"])
        elif what == "recording":
            self._on_trouble(f"recording to {said['path']}")
        elif what == "ask":
            self._children["reader"].line.tell("ask")
        elif what in ("reopened", "tracking"):
            self._said = ""
        elif what == "played":
            self._played = True

    def _tell_once(self, sentence: str) -> None:
        """Tell of trouble, but not again while nothing else has happened."""
        if sentence != self._said:
            self._said = sentence
            self._on_trouble(sentence)

    def _shut_down(self) -> LimbcalError | None:
        """Stop the processes in the order in which data flows; return what went wrong in that."""
        notify(STOPPING=1, STATUS="stopping")
        trouble: LimbcalError | None = None
        for name in ("reader", "pipeline", "recorder", "replay"):
            child = self._children.get(name)
            if child is None:
                continue
            if not child.end(_PATIENCE_S[name]):
                limit = _PATIENCE_S[name]
                trouble = trouble or DeviceError(f"the {name} process did not stop within {limit:g} s: killed")
            for said in child.said() or []:
                try:
                    self._note(child, said)
                except LimbcalError as error:
                    trouble = trouble or error
            child.close()
        self._clear_rooms()
        closed = self._heard.get(("recorder", "closed"))
        if closed is not None and closed["lost"]:
            failed = self._heard["recorder", "disk-failed"]
            trouble = trouble or DeviceError(f"the recording is incomplete: {failed['sentence']}")
        return trouble

    def _recording_path(self, directory: str) -> str:
        now = datetime.now(UTC)
        name = f"{self._setup.arm.name}-{now:%Y%m%dT%H%M%SZ}-{self._run[:8]}.mcap"
        return str(Path(directory).absolute() / name)  # as subscribers elsewhere on this machine find it

    def _room(self) -> str:
        """Return an endpoint that only this user can reach; once both ends are there its name can go."""
        room = tempfile.mkdtemp(prefix="limbd-")
        self._rooms.append(room)
        return f"ipc://{room}/recorder"

    def _clear_rooms(self) -> None:
        while self._rooms:
            shutil.rmtree(self._rooms.pop(), ignore_errors=True)
