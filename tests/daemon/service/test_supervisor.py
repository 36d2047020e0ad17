"""Who is to blame when several processes end at once."""

from multiprocessing import get_context

import pytest

from daemon.config.config import load_setup
from daemon.process.child_process import ChildProcess
from daemon.process.control_line import ControlLine
from daemon.process.stop_signal import StopSignal
from daemon.service.supervisor import Supervisor
from limbcal.errors import DeviceError


class Talker(ChildProcess):
    """A child that the test speaks for."""

    def __init__(self, name: str) -> None:
        self.name = name
        ours, theirs = get_context("spawn").Pipe()
        self.line, self.voice = ControlLine(ours), ControlLine(theirs)

    def ended(self) -> DeviceError:
        return DeviceError(f"{self.name} ended")

    def close(self) -> None:
        self.line.close()
        self.voice.close()


def test_a_recorder_that_closed_its_file_leaves_the_word_to_the_pipeline() -> None:
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})
    recorder, pipeline = Talker("recorder"), Talker("pipeline")
    with StopSignal() as stop:
        supervisor = Supervisor(setup, stop, lambda said: None, lambda said: None, lambda said: None)
        supervisor._children = {"recorder": recorder, "pipeline": pipeline}
        recorder.voice.tell("closed", messages=0)
        recorder.voice.close()
        supervisor._listen()
        supervisor._listen()
        pipeline.voice.tell("failed", kind="DeviceError", sentence="no valid frame")
        with pytest.raises(DeviceError, match="no valid frame"):
            supervisor._listen()
    recorder.close()
    pipeline.close()


def test_a_recorder_that_ends_before_its_file_is_closed_is_to_blame() -> None:
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})
    recorder = Talker("recorder")
    with StopSignal() as stop:
        supervisor = Supervisor(setup, stop, lambda said: None, lambda said: None, lambda said: None)
        supervisor._children = {"recorder": recorder}
        recorder.voice.close()
        with pytest.raises(DeviceError, match="recorder ended"):
            supervisor._listen()
    recorder.close()


def test_what_the_recorder_could_not_write_is_said_at_the_end() -> None:
    setup = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})
    for heard, said in (
        ({}, None),
        ({("recorder", "closed"): {"lost": 0}}, None),
        (
            {("recorder", "closed"): {"lost": 3}, ("recorder", "disk-failed"): {"sentence": "no room"}},
            "the recording is incomplete: no room",
        ),
    ):
        with StopSignal() as stop:
            supervisor = Supervisor(setup, stop, lambda said: None, lambda said: None, lambda said: None)
            supervisor._heard.update(heard)
            trouble = supervisor._shut_down()
        assert (None if trouble is None else str(trouble)) == said
