"""The reader on a real tty: what it says, what it sends, and how it takes up a port that went away."""

import threading
import time
from collections.abc import Callable, Iterator
from multiprocessing import get_context
from pathlib import Path

import pytest

from daemon.acquisition.reader import run_reader
from daemon.acquisition.ring import Chunk, Mark, Ring, ring_memory
from daemon.process.control_line import ControlLine
from tests.daemon.conftest import PtyDevice, device_info, wait_until
from tests.patience import PATIENCE_S

MakeDevice = Callable[..., PtyDevice]


class Reading:
    """A reader in a thread, and the supervisor's and the pipeline's ends of it."""

    def __init__(self, port: Path, wait: bool) -> None:
        ours, theirs = get_context("spawn").Pipe()
        self.line, self._theirs = ControlLine(ours), ControlLine(theirs)
        memory = ring_memory(get_context("spawn"), 1 << 16)
        self.ring, self.chunks = Ring(memory), list[Chunk]()
        self.error: Exception | None = None
        self.began_s = time.monotonic()
        self._thread = threading.Thread(target=self._read, args=(memory, str(port), wait))
        self._thread.start()

    def hears(self, *whats: str) -> list[dict[str, object]]:
        """Return what the supervisor hears next, which must be this."""
        found = [self.line.hear(PATIENCE_S) for _ in whats]
        assert [None if one is None else one["what"] for one in found] == list(whats)
        return [one for one in found if one is not None]

    def data(self, mark: Mark = Mark.DATA) -> bytes:
        """Return all that has come so far."""
        self.chunks += self.ring.read()
        return b"".join(chunk.data for chunk in self.chunks if chunk.mark is mark)

    def marks(self) -> list[Mark]:
        self.data()
        return [chunk.mark for chunk in self.chunks if chunk.mark is not Mark.DATA]

    def end(self) -> None:
        if self._thread.is_alive():
            self.line.tell("stop")
        self._thread.join(PATIENCE_S)
        self.line.close()
        self._theirs.close()

    def _read(self, memory: object, port: str, wait: bool) -> None:
        try:
            run_reader(self._theirs, memory, port, 115_200, wait)  # type: ignore[arg-type]
        except Exception as error:  # noqa: BLE001 - the test looks at it
            self.error = error


@pytest.fixture
def reading() -> Iterator[Callable[..., Reading]]:
    made: list[Reading] = []

    def start(port: Path, wait: bool = False) -> Reading:
        made.append(Reading(port, wait))
        return made[-1]

    yield start
    for one in made:
        one.end()


@pytest.fixture
def device(
    pty_device: MakeDevice,
) -> PtyDevice:
    return pty_device(device_info(8000.0), on_start=b"samples")


@pytest.fixture
def port(tmp_path: Path, device: PtyDevice) -> Path:
    """Return a name for the device, which can be taken away."""
    name = tmp_path / "port"
    name.symlink_to(device.path)
    return name


def test_commands_go_out_and_bytes_come_in(reading: Callable[..., Reading], port: Path, device: PtyDevice) -> None:
    one = reading(port)
    one.hears("ready")
    assert device.commands == b"STOP\n"
    one.line.tell("ask")
    wait_until(lambda: device.commands.endswith(b"INFO\n"), "INFO is asked for")
    one.line.tell("start")
    wait_until(lambda: one.data().endswith(b"samples"), "samples come")
    assert device.commands.startswith(b"STOP\nINFO\nSTART\n")
    one.end()
    assert device.commands.endswith(b"STOP\n")
    assert one.error is None
    assert set(one.marks()) == {Mark.ASKED}
    assert one.ring.closed


def test_what_a_device_held_back_is_of_the_past(
    reading: Callable[..., Reading], port: Path, device: PtyDevice
) -> None:
    device.write(b"old")
    one = reading(port)
    one.hears("ready")
    device.write(b"new")
    wait_until(lambda: one.data() == b"new", "the new comes alone")


def test_what_comes_after_a_stop_is_still_read(
    reading: Callable[..., Reading], port: Path, device: PtyDevice
) -> None:
    one = reading(port)
    one.hears("ready")
    device.write(10_000 * b"12345")
    one.end()
    assert one.data() == 10_000 * b"12345"


def test_a_name_that_means_another_device_is_opened_anew(
    reading: Callable[..., Reading], port: Path, device: PtyDevice, pty_device: MakeDevice
) -> None:
    one = reading(port)
    one.hears("ready")
    one.line.tell("start")
    wait_until(lambda: one.data().endswith(b"samples"), "samples come")
    other = pty_device(None, on_start=b"others")
    port.unlink()
    port.symlink_to(other.path)
    said = one.hears("waiting", "reopened")
    assert "another device file" in str(said[0]["sentence"])
    wait_until(lambda: one.data().endswith(b"others"), "the other's samples come")
    marks = one.marks()
    assert [mark for mark in marks if mark is not Mark.ASKED] == [Mark.LOST, Mark.OPENED]
    assert marks[marks.index(Mark.OPENED) + 1] is Mark.ASKED
    assert one.data(Mark.LOST).decode() == said[0]["sentence"]
