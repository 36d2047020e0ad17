"""The daemon's tests run the real programs, on real ptys; nothing may be left when a test ends."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tty
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from select import select
from typing import Any

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray

from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import encode_info
from tests.patience import PATIENCE_S

SCALE = 0.0015
DD_CHANNELS = tuple(f"s{k}{axis}" for k in (1, 2, 3, 4) for axis in "xyz")


def device_info(rate_hz: float = 8000.0, names: Sequence[str] = DD_CHANNELS) -> DeviceInfo:
    """Describe a device."""
    channels = tuple(Channel(name, SCALE, 0.0, 49.0) for name in names)
    return DeviceInfo("test device", "1", "1", rate_hz, 1e6, channels)


def resting_counts(n_sample: int) -> NDArray[np.int16]:
    """Return noise about what level sensors at rest read."""
    noise = np.random.default_rng(7).integers(-20, 20, (n_sample, len(DD_CHANNELS)))
    noise[:, 2::3] += round(9.80665 / SCALE)
    return noise.astype(np.int16)


def wait_until(condition: Callable[[], bool], what: str, patience_s: float = PATIENCE_S) -> None:
    end = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < end, f"waited in vain until {what}"
        threading.Event().wait(0.01)


class Program:
    """`limbd` as a process of its own; what it says on stderr goes to a file."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.stderr_path = Path(tempfile.mkstemp(dir=folder, suffix=".err")[1])
        with self.stderr_path.open("wb") as stderr:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "daemon", *arguments], stdout=subprocess.PIPE, stderr=stderr, text=True
            )
        self.family: list[psutil.Process] = []

    @property
    def said(self) -> str:
        return " ".join(self.stderr_path.read_text().split())

    def announcement(self) -> dict[str, Any]:
        """Wait for the JSON line, and note which processes there are."""
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line, f"ended with {self.process.wait(PATIENCE_S)}: {self.said}"
        self.family = psutil.Process(self.process.pid).children(recursive=True)
        document: dict[str, Any] = json.loads(line)
        return document

    def signal(self, number: int = signal.SIGTERM) -> None:
        self.process.send_signal(number)

    def wait(self) -> int:
        """Wait for its end and that of its family; return the exit code."""
        code = self.process.wait(PATIENCE_S)
        _, alive = psutil.wait_procs(self.family, timeout=PATIENCE_S)
        left = [p for p in alive if p.is_running() and p.status() != psutil.STATUS_ZOMBIE]
        assert not left, f"left behind: {left}"
        return code

    def stop(self) -> int:
        self.signal()
        return self.wait()

    def cleanup(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(PATIENCE_S)
        if self.process.stdout is not None:
            self.process.stdout.close()


class PtyDevice:
    """A device under the test's control, on a real pty: answers INFO and writes what the test hands it.

    ``on_start`` is written when START comes for the first time, ``chatter`` all the time.
    """

    def __init__(self, info: DeviceInfo | None, on_start: bytes = b"", chatter: bytes = b"") -> None:
        self.commands = b""
        self._chatter = chatter
        self._info = info
        self._on_start = on_start
        self._outgoing = bytearray()
        self._lock = threading.Lock()
        self._master, self._slave = os.openpty()
        self.path = os.ttyname(self._slave)
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self._wake_read, self._wake_write = os.pipe()
        self._stopping = False
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def write(self, data: bytes) -> None:
        with self._lock:
            self._outgoing += data
        os.write(self._wake_write, b".")

    def introduce(self, info: DeviceInfo) -> None:
        """Be another device from now on."""
        with self._lock:
            self._info = info

    def close(self) -> None:
        if self._master >= 0:
            self._stopping = True
            os.write(self._wake_write, b".")
            self._thread.join(PATIENCE_S)
            for descriptor in (self._master, self._slave, self._wake_read, self._wake_write):
                os.close(descriptor)
            self._master = -1

    def _serve(self) -> None:
        pending = b""
        while not self._stopping:
            if self._chatter and not self._outgoing:
                self.write(self._chatter)
            writers = [self._master] if self._outgoing else []
            readable, writable, _ = select([self._master, self._wake_read], writers, [], 1.0)
            if self._wake_read in readable:
                os.read(self._wake_read, 4096)
            if self._master in readable:
                data = os.read(self._master, 4096)
                self.commands += data
                *lines, pending = (pending + data).split(b"\n")
                for line in lines:
                    self._obey(line)
            if writable:
                with self._lock:
                    sent = os.write(self._master, bytes(self._outgoing[:8192]))
                    del self._outgoing[:sent]

    def _obey(self, command: bytes) -> None:
        answer = b""
        if command in (b"INFO", b"START") and self._info is not None:
            answer += encode_info(self._info, 0, 0)
        if command == b"START":
            answer += self._on_start
            self._on_start = b""
        with self._lock:
            self._outgoing += answer


@pytest.fixture
def limbd(tmp_path: Path) -> Iterator[Callable[..., Program]]:
    """Start `limbd` with some arguments; the paper's method, which starts sooner, unless they name another."""
    programs: list[Program] = []

    def start(*arguments: str) -> Program:
        if arguments[0] == "run" and not {"--method", "--config", "--replay"} & set(arguments):
            arguments += ("--method", "integrate")
        programs.append(Program(tmp_path, *arguments))
        return programs[-1]

    yield start
    for program in reversed(programs):
        program.cleanup()


@pytest.fixture
def pty_device() -> Iterator[Callable[..., PtyDevice]]:
    """Make a device on a pty."""
    devices: list[PtyDevice] = []

    def make(info: DeviceInfo | None, on_start: bytes = b"", chatter: bytes = b"") -> PtyDevice:
        devices.append(PtyDevice(info, on_start, chatter))
        return devices[-1]

    yield make
    for device in devices:
        device.close()


@pytest.fixture(scope="session", autouse=True)
def own_temporary_folder() -> Iterator[None]:
    """Keep these tests' temporary folders apart from those of a service that runs on this machine."""
    with tempfile.TemporaryDirectory(prefix="lt-") as folder, pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", folder)
        patch.setattr(tempfile, "tempdir", folder)
        yield


@pytest.fixture(autouse=True)
def nothing_left() -> Iterator[None]:
    """Fail a test that leaves a process, shared memory, a temporary folder, a descriptor or a thread."""
    before = _belongings()
    yield
    end = time.monotonic() + PATIENCE_S
    while (left := _belongings() - before) and (left := left - _of_others()) and time.monotonic() < end:
        threading.Event().wait(0.05)
    assert not left


def _belongings() -> set[str]:
    temporary = Path(tempfile.gettempdir())
    return {
        *(f"process {pid}" for pid in _descendants("self") if _is_left(pid)),
        *(f"shared memory {entry.name}" for entry in Path("/dev/shm").iterdir()),
        *(f"folder {entry}" for entry in temporary.glob("limbd-*")),
        *(f"thread {thread.name}" for thread in threading.enumerate()),
        *(f"descriptor {name} {target}" for name, target in _descriptors()),
    }


def _of_others() -> set[str]:
    """Return the shared memory that other programs on this machine have mapped."""
    me = psutil.Process()
    own = {me.pid, *(child.pid for child in me.children(recursive=True))}
    found = set[str]()
    for process in psutil.process_iter():
        if process.pid in own:
            continue
        try:
            paths = [one.path for one in process.memory_maps()]
        except (psutil.Error, OSError):
            continue
        found |= {f"shared memory {Path(path).name}" for path in paths if path.startswith("/dev/shm/")}
    return found


def _descriptors() -> list[tuple[str, str]]:
    found = []
    for entry in Path("/proc/self/fd").iterdir():
        try:
            target = os.readlink(entry)
        except OSError:
            continue
        if target.startswith(("/dev/pts", "/dev/ptmx", "socket:")):
            found.append((entry.name, target))
    return found


def _descendants(process: str) -> Iterator[str]:
    """Yield the numbers of all processes below one; the kernel's own list takes no look at everybody's."""
    try:
        threads = list(Path(f"/proc/{process}/task").iterdir())
    except OSError:  # it has ended
        return
    for thread in threads:
        try:
            children = (thread / "children").read_text().split()
        except OSError:  # this one has
            continue
        for child in children:
            yield child
            yield from _descendants(child)


def _is_left(process: str) -> bool:
    """Say whether a process lives that is not multiprocessing's own."""
    try:
        one = psutil.Process(int(process))
        return one.status() != psutil.STATUS_ZOMBIE and "resource_tracker" not in " ".join(one.cmdline())
    except psutil.Error:
        return False
