"""What the pipeline hands over is in the file byte for byte."""

import threading
from collections.abc import Iterator
from multiprocessing import get_context
from pathlib import Path

import msgpack
import pytest
import zmq

from daemon.process.control_line import ControlLine
from daemon.recording.record_link import Context, RecordLink
from daemon.recording.recorder import run_recorder
from daemon.recording.segments import Limits
from limbcal.errors import DeviceError
from protocol.message import GAP, TRIAL, encode
from protocol.recording_reader import read_recording, recording_attachments
from tests.patience import PATIENCE_S

LIMITS = Limits(10**9, 3600.0, 0)


@pytest.fixture
def context() -> Iterator[Context]:
    with zmq.Context() as made:  # also where a test failed and left a socket
        yield made


class Recorder:
    """The recorder in a thread, and the supervisor's end of its line."""

    def __init__(self, folder: Path) -> None:
        self.endpoint = f"ipc://{folder}/recorder"
        self.path = folder / "new" / "file.mcap"
        ours, theirs = get_context("spawn").Pipe()
        self.line, self._its_line = ControlLine(ours), ControlLine(theirs)
        self._thread = threading.Thread(
            target=run_recorder,
            args=(self._its_line, self.endpoint, str(self.path), "arm text", "config text", LIMITS),
        )
        self._thread.start()
        self.expect("ready")

    def expect(self, what: str) -> dict[str, object]:
        said = self.line.hear(PATIENCE_S)
        assert said is not None
        assert said["what"] == what
        return said

    def join(self) -> None:
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()

    def close(self) -> None:
        """End it, whatever a test has left undone: its context is closed by its thread alone."""
        self.line.close()
        self.join()
        self._its_line.close()


@pytest.fixture
def recorder(tmp_path: Path) -> Iterator[Recorder]:
    started = Recorder(tmp_path)
    yield started
    started.close()


def trial_message(number: int) -> list[bytes]:
    return encode(TRIAL, {"trial": number, "t_ns": 5, "state": "begin", "role": "learn"})


def gap_message(number: int) -> list[bytes]:
    return encode(GAP, {"sample0": number, "samples": 1, "t_ns": 5, "why": "unplugged", "exact": True})


def test_every_message_is_recorded_as_it_was(recorder: Recorder, context: Context) -> None:
    link = RecordLink(context, recorder.endpoint, str(recorder.path))
    recorder.expect("linked")
    for number in range(500):
        link.write(gap_message(number), 1000 + number)
    link.close()
    assert recorder.expect("closed")["messages"] == 500
    recorder.join()
    reader = read_recording(recorder.path)
    recorded = list(reader.payloads())
    assert recorded == [(GAP, gap_message(k)[1], 1000 + k, "msgpack") for k in range(500)]
    assert not reader.cut
    assert recording_attachments(recorder.path) == {"arm.toml": b"arm text", "limbd.toml": b"config text"}
    assert link.lost == 0


def test_a_pipeline_that_says_no_goodbye_is_not_waited_for(recorder: Recorder, context: Context) -> None:
    socket = context.socket(zmq.PAIR)
    socket.connect(recorder.endpoint)
    for number in range(20):
        socket.send(msgpack.packb([(*trial_message(number), 0)]))
    recorder.expect("linked")
    recorder.line.tell("stop")
    assert recorder.expect("closed")["messages"] == 20
    recorder.join()
    socket.close(0)


def test_a_directory_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    ours, theirs = get_context("spawn").Pipe()
    line = ControlLine(theirs)
    with pytest.raises(DeviceError, match=r"record.directory .*file/rec cannot be made: Not a directory"):
        run_recorder(line, f"ipc://{tmp_path}/r", str(tmp_path / "file" / "rec" / "x.mcap"), "", "", LIMITS)
    line.close()
    ours.close()
