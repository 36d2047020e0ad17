"""Motions to play, a clock to play them by, and a playback that really runs."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq

from arm.arm_file import load_arm
from arm.model import Arm
from playback.client import ask
from playback.control_message import Request
from playback.playhead import Clocks
from playback.source import Source
from playback.trajectory import Trajectory
from tests.patience import PATIENCE_MS

START_NS = 1_700_000_000_123_456_789


@dataclass
class FakeTime:
    """A clock that moves when the test says so."""

    now_s: float = 100.0
    slept: list[float] = field(default_factory=list)

    @property
    def clocks(self) -> Clocks:
        return Clocks(lambda: self.now_s, lambda: START_NS + round((self.now_s - 100.0) * 1e9))

    def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        self.now_s += seconds


@pytest.fixture
def fake_time() -> FakeTime:
    return FakeTime()


@pytest.fixture(scope="session")
def arm() -> Arm:
    return load_arm("dd-arm")


@pytest.fixture(scope="session")
def source(arm: Arm) -> Source:
    """Three trials, of 0.5, 1 and 1.5 s."""
    motions = {trial: wave(trial, 0.5 * trial) for trial in (1, 2, 3)}
    return Source("waves", arm, {n: motion.duration_s for n, motion in motions.items()}, motions.__getitem__)


def wave(trial: int, duration_s: float) -> Trajectory:
    t = np.linspace(0.0, duration_s, 501)
    phase = trial * t[:, None] * np.array([1.0, 2.0])
    rate = trial * np.array([1.0, 2.0])
    return Trajectory(t, np.sin(phase), rate * np.cos(phase), -(rate**2) * np.sin(phase), "file")


@pytest.fixture(scope="session")
def context() -> Iterator[zmq.Context[zmq.Socket[bytes]]]:
    with zmq.Context() as context:
        yield context


@dataclass(frozen=True)
class Running:
    """A `limbplay serve` in a process of its own."""

    process: subprocess.Popen[str]
    endpoint: str
    control: str
    context: zmq.Context[zmq.Socket[bytes]]

    def ask(self, cmd: str, value: float | None = None) -> dict[str, Any]:
        return ask(self.context, self.control, Request(cmd, value), PATIENCE_MS)


@pytest.fixture(scope="session")
def start(
    context: zmq.Context[zmq.Socket[bytes]], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., AbstractContextManager[Running]]:
    """Return what starts `limbplay serve` with its arguments, and ends it."""

    @contextmanager
    def started(*arguments: object) -> Iterator[Running]:
        folder = tmp_path_factory.mktemp("endpoints")
        endpoint, control = f"ipc://{folder}/play", f"ipc://{folder}/control"
        command = [sys.executable, "-m", "playback", "serve", *map(str, arguments)]
        command += ["--endpoint", endpoint, "--control", control]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            try:
                yield Running(process, endpoint, control, context)
            finally:
                process.kill()

    return started


@pytest.fixture(scope="session")
def motion_file(source: Source, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the three trials to a file."""
    rows = []
    for trial in source.trials:
        motion = source.load(trial)
        rows.append(np.column_stack([motion.t, motion.q, motion.dq, motion.ddq, np.full(len(motion.t), trial)]))
    table = np.concatenate(rows)
    names = ["t", "q1", "q2", "dq1", "dq2", "ddq1", "ddq2", "trial"]
    path = tmp_path_factory.mktemp("motion") / "waves.npz"
    np.savez(path, **dict(zip(names, table.T, strict=True)))
    return path
