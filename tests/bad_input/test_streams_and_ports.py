"""Streams, endpoints, ports and pipes that are not what they should be."""

import os
import select
import subprocess
import sys
import tempfile
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
import zmq

import daemon.__main__
from protocol.curve import new_client
from protocol.message import FRAMES, encode
from protocol.publisher import Publisher
from tests.patience import PATIENCE_S


@pytest.mark.parametrize("arm", [("--arm", "dd-arm"), ()], ids=["with an arm", "without"])
def test_a_message_of_another_version(said, stream, short_run, arm):
    topic, fields = short_run.messages[0]
    payload = encode(topic, fields)[1].replace(b"\xa1v\x01", b"\xa1v\x07")
    with (
        tempfile.TemporaryDirectory() as place,
        stream("tcp://127.0.0.1:*", [[FRAMES.encode(), payload]]) as hostile,
    ):
        common = ("--connect", hostile.endpoint, "--endpoint", f"ipc://{place}/fits", "--seconds", "60")
        assert said(2, "subscribe", *common, *arm) == "limb/frames: message version is 7, expected 1"


def test_an_endpoint_that_is_taken(said):
    with tempfile.TemporaryDirectory() as place, zmq.Context() as context:
        with Publisher(context, "tcp://127.0.0.1:*", "x", "y") as publisher:
            common = ("--connect", f"ipc://{place}/frames", "--endpoint", publisher.endpoint, "--arm", "dd-arm")
            sentence = said(3, "subscribe", *common)
    assert sentence == f"endpoint {publisher.endpoint} is already taken, expected a free one"


def limbd(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "daemon", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)


def sentence_of(process: subprocess.CompletedProcess[str]) -> str:
    assert "Traceback" not in process.stderr
    (error,) = [line for line in process.stderr.splitlines() if line.startswith("error: ")]
    return error.removeprefix("error: ")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no disk that is always full")
def test_an_answer_that_nobody_can_take(tmp_path):
    (tmp_path / "limbd.toml").write_text('[device]\nport = "/dev/limbcal"\n[arm]\nfile = "dd-arm"\n')
    command = [sys.executable, "-m", "daemon", "check", str(tmp_path / "limbd.toml"), "--json"]
    with open("/dev/full", "w", encoding="utf-8") as full:
        process = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert process.returncode == 3
    assert sentence_of(process) == "stdout cannot be written: No space left on device"


@contextmanager
def babbling_port() -> Iterator[str]:
    """Open a pseudo-terminal on which somebody sends noise, and only noise."""
    master, slave = os.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    over, noise = threading.Event(), np.random.default_rng(0).bytes(4096)

    def babble() -> None:
        while not over.is_set():
            if select.select([], [master], [], 0.05)[1]:
                os.write(master, noise)

    thread = threading.Thread(target=babble)
    thread.start()
    try:
        yield os.ttyname(slave)
    finally:
        over.set()
        thread.join()
        os.close(master)
        os.close(slave)


def test_a_key_that_is_none_is_said_before_anybody_is_locked_out(tmp_path):
    """One broken file in the list of keys would keep all others from being read."""
    new_client(tmp_path / "keys", "friend", tmp_path / "friend.limbkey")
    broken = tmp_path / "keys" / "clients" / "broken.key"
    broken.write_text("public-key = 7\n")
    with babbling_port() as port:
        config = tmp_path / "limbd.toml"
        config.write_text(
            f'[device]\nport = "{port}"\n[arm]\nfile = "dd-arm"\n'
            f'[publish]\nendpoint = "tcp://127.0.0.1:*"\nkeys = "{tmp_path}/keys"\n'
        )
        process = limbd("run", "--config", config)
    assert process.returncode == 2
    assert sentence_of(process) == f"{broken}: its public key is none, expected 40 characters of Z85"


def test_an_endpoint_that_is_a_file_is_said_and_the_file_stays(tmp_path):
    place = tmp_path / "results.csv"
    place.write_text("t,q1\n")
    with babbling_port() as port:
        process = limbd("run", "--port", port, "--arm", "dd-arm", "--endpoint", f"ipc://{place}")
    assert process.returncode == 2
    said = sentence_of(process)
    assert said == f"endpoint ipc://{place} is a file that is no socket; expected a path that is free"
    assert place.read_text() == "t,q1\n"


@pytest.mark.parametrize("endpoint", ["tipc://{5560,0,0}", "ws://0.0.0.0:5770", "tcp://127.0.0.1:5770;0.0.0.0:1"])
def test_an_endpoint_of_another_form_is_said(run, endpoint):
    outcome = run(daemon.__main__.main, "run", "--port", "/dev/nope", "--arm", "dd-arm", "--endpoint", endpoint)
    assert outcome.code == 2
    assert f"publish.endpoint is {endpoint!r}, expected " in outcome.errors[0]
