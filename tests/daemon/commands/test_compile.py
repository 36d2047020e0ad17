"""`limbd compile`."""

import json

import pytest

from daemon.__main__ import main


def test_the_command_says_how_many(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("daemon.service.kernels.compile_all", lambda: None)
    assert main(["compile", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"compiled": 0}
