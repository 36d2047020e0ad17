"""`fitter subscribe` where there is nothing to learn: what it says, and how it ends."""

import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest
import zmq

from arm.arm_file import save_arm
from protocol.publisher import Publisher
from tests.fitter.commands.followed import LIMIT, names, until
from tests.patience import PATIENCE_MS

#: A test that waits in vain fails.


def test_frames_that_make_no_sense_end_it(fitter, stream, place, short_run, tmp_path):
    topic, fields = short_run.messages[0]
    with stream("tcp://127.0.0.1:*", [(topic, fields | {"q": fields["q"][:-1]})]) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, *LIMIT, "--out", tmp_path)
    assert outcome.code == 2 and len(outcome.errors) == 1
    assert "limb/frames: a field is missing or does not fit" in outcome.errors[0]
    assert names(tmp_path) == []


@pytest.mark.parametrize("arm", [("--arm", "dd-arm"), ()])
def test_a_stop_before_anything_came_is_no_error(fitter, stream, place, tmp_path, arm):
    """The stream stands for a daemon whose arm has not moved; without --arm not even that has come."""
    with stream("tcp://127.0.0.1:*", ()) as daemon, interrupted_by(daemon):
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", *arm)
        outcome = fitter("subscribe", *common, *LIMIT, "--out", tmp_path)
    assert outcome.code == 0
    assert "stopped" in outcome.said
    assert names(tmp_path) == []


class interrupted_by:  # noqa: N801 - reads as a sentence
    """Send this process SIGTERM as soon as the command has connected: by then it has its handler."""

    def __init__(self, daemon):
        import threading  # noqa: PLC0415

        self._thread = threading.Thread(target=self._wait, args=(daemon,))

    def _wait(self, daemon):
        if daemon.connected.wait(PATIENCE_MS / 1000):
            os.kill(os.getpid(), signal.SIGTERM)

    def __enter__(self):
        self._thread.start()

    def __exit__(self, *_):
        self._thread.join()


def test_nothing_received_is_a_failure_of_the_device(fitter, place):
    nowhere = ("--connect", f"ipc://{place}/nobody", "--endpoint", f"ipc://{place}/fits", "--seconds", "0.2")
    for arm in ((), ("--arm", "dd-arm")):
        outcome = fitter("subscribe", *nowhere, *arm)
        assert outcome.code == 3 and len(outcome.errors) == 1
        assert f"ipc://{place}/nobody: nothing was received" in outcome.errors[0]


def test_an_arm_that_does_not_move_tells_nothing(fitter, stream, place, short_run, tmp_path):
    resting = short_run.messages[:4]
    with stream("tcp://127.0.0.1:*", resting) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", "--arm", "dd-arm")
        outcome = fitter("subscribe", *common, "--seconds", "1.5", "--out", tmp_path)
    assert outcome.code == 4 and len(outcome.errors) == 1
    assert "no learning motion ended in " in outcome.errors[0]
    assert names(tmp_path) == []


def test_motions_of_another_arm_are_left_out(fitter, stream, place, short_run, tmp_path):
    save_arm(replace(short_run.arm, joints=short_run.arm.joints[:1], sensors=(), tip=None), tmp_path / "one.toml")
    text = (tmp_path / "one.toml").read_text().replace("[9.5, 9.5]", "[9.5]").replace("[-9.5, -9.5]", "[-9.5]")
    (tmp_path / "one.toml").write_text(text)
    with stream("tcp://127.0.0.1:*", until(short_run.messages, 1, "end")) as daemon:
        common = ("--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits")
        outcome = fitter("subscribe", *common, "--arm", tmp_path / "one.toml", "--seconds", "1.5")
    assert outcome.code == 4
    assert "trial 1 is left out: frames of 2 joint angles, expected 1 as dd-arm has" in outcome.said


def test_a_stream_of_an_arm_that_nobody_knows(fitter, stream, place, short_run):
    with stream("tcp://127.0.0.1:*", arm_name="lab-arm") as daemon:
        outcome = fitter("subscribe", "--connect", daemon.endpoint, "--endpoint", f"ipc://{place}/fits", *LIMIT)
    assert outcome.code == 2
    assert outcome.errors == [
        "error: the stream is of arm 'lab-arm', which is not built in; expected --arm with its file"
    ]


def test_endpoints_that_cannot_be_used(fitter, place):
    taken = f"ipc://{place}/taken"
    with zmq.Context() as context, Publisher(context, taken, "x", "y"):
        outcome = fitter("subscribe", "--connect", f"ipc://{place}/d", "--endpoint", taken, "--arm", "dd-arm")
    assert outcome.code == 3
    assert outcome.errors == [f"error: endpoint {taken} is already taken, expected a free one"]
    outcome = fitter("subscribe", "--connect", "somewhere", "--arm", "dd-arm")
    assert outcome.code == 2
    assert outcome.errors == [
        "error: endpoint is 'somewhere', expected such as tcp://127.0.0.1:5770 or ipc:///run/limb"
    ]


def test_a_place_that_cannot_be_written_to_is_told_before_anything_is_followed(fitter, place, tmp_path):
    (tmp_path / "file").write_text("")
    # The second is a folder that is there, and takes no file, whoever asks.
    for out, why in (
        (tmp_path / "file" / "below", "Not a directory"),
        (Path("/proc"), "No such file or directory"),
    ):
        outcome = fitter(
            "subscribe", "--connect", f"ipc://{place}/nobody", "--arm", "dd-arm", "--out", out, "--seconds", "0.2"
        )
        assert outcome.code == 3
        assert outcome.errors == [f"error: {out}: nothing can be written there: {why}"]
    assert Path(place).is_dir() and names(Path(place)) == []
