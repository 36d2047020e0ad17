"""One request to a playback: what goes with it, and its answer in words."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import zmq

from playback.__main__ import main
from playback.control_message import decode_request, encode_refusal, encode_reply
from playback.control_socket import ControlSocket
from tests.playback.served import served

STATE = {"trial": 2, "lateness_ms": {"p50": 0.5}}
Asked = Callable[..., tuple[int, list[Any]]]


@pytest.fixture
def asked(tmp_path: Path) -> Iterator[Asked]:
    """Return what sends a request to a playback that answers any, and tells the exit code and the request."""
    requests: list[Any] = []

    def answer(parts: Any) -> bytes:
        requests.append(decode_request(parts))
        if requests[-1].cmd == "pause":
            return encode_refusal("it holds already")
        return encode_reply(STATE, trials=[1, 2])

    with zmq.Context() as context:
        socket = ControlSocket(context, f"ipc://{tmp_path}/control", answer)

        def send(*arguments: str) -> tuple[int, list[Any]]:
            requests.clear()
            return main(["send", *arguments, "--control", socket.endpoint]), [*requests]

        with served(socket):
            yield send


@pytest.mark.parametrize(
    ("arguments", "value"),
    [
        (["play"], None),
        (["load", "--trial", "7"], 7),
        (["seek", "--position", "0"], 0.0),
        (["speed", "--speed", "2.5"], 2.5),
        (["loop"], True),
        (["loop", "--loop", "on"], True),
        (["loop", "--loop", "off"], False),
        (["step"], 1),
        (["step", "--frames", "-3"], -3),
        (["step", "--frames", "0"], 0),
    ],
)
def test_a_request_has_what_was_typed(asked: Asked, arguments: list[str], value: object) -> None:
    code, (request,) = asked(*arguments)
    assert (code, request.cmd, request.value) == (0, arguments[0], value)
    assert type(request.value) is type(value)


def test_the_answer_is_a_name_and_a_value_a_line(asked: Asked, capsys: pytest.CaptureFixture[str]) -> None:
    asked("play")
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["ok: True", "state trial: 2", "state lateness_ms: {'p50': 0.5}", "trials: [1, 2]"]


def test_the_document_is_all_that_stdout_gets(asked: Asked, capsys: pytest.CaptureFixture[str]) -> None:
    asked("play", "--json")
    assert json.loads(capsys.readouterr().out) == {"v": 1, "ok": True, "state": STATE, "trials": [1, 2]}


def test_a_refusal_is_exit_code_2_and_a_document(asked: Asked, capsys: pytest.CaptureFixture[str]) -> None:
    code, _ = asked("pause")
    output = capsys.readouterr()
    assert (code, output.out) == (2, "") and "playback refused pause: it holds already" in output.err
    code, _ = asked("pause", "--json")
    assert code == 2 and json.loads(capsys.readouterr().out)["error"] == "it holds already"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["speed"], "speed: --speed goes with speed, and is missing"),
        (["state", "--loop", "off"], "state: --loop goes with loop, and only with it"),
        (["seek", "--frames", "0"], "seek: --frames goes with step, and only with it"),
        (
            ["load", "--trial", "99999999999999999999"],
            "load: --trial is 99999999999999999999, expected a whole number from -9223372036854775807 to "
            "9223372036854775807",
        ),
        (["step", "--frames", "-9223372036854775808"], "step: --frames is -9223372036854775808, expected a whole"),
        (["seek", "--position", "nan"], "seek: --position is nan, expected a number of seconds"),
        (["loop", "--loop", "maybe"], "there is no value 'maybe', expected one of on, off"),
    ],
)
def test_what_does_not_belong_together_is_not_sent(
    asked: Asked, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, requests = asked(*arguments)
    assert (code, requests) == (2, []) and said in " ".join(capsys.readouterr().err.split())


def test_a_key_that_is_not_there_is_said(asked: Asked, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked("state", "--key", "nowhere.limbkey") == (2, [])
    assert "nowhere.limbkey" in capsys.readouterr().err


def test_what_plays_is_not_loaded() -> None:
    code = "import sys, playback.commands.send; print('numba' in sys.modules, 'playback.player' in sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said.split() == ["False", "False"]
