"""`limbd install`."""

import json
from pathlib import Path

import pytest

from daemon.__main__ import main


def test_options_of_an_installation_are_passed_on(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[object] = []

    def installed(*what: object) -> dict[str, object]:
        asked.append(what)
        return {"done": []}

    monkeypatch.setattr("daemon.service.installation.install", installed)
    assert main(["install", "--dry-run", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"done": []}
    assert main(["install", "--remove", "--prefix", "/srv"]) == 0
    assert asked == [(Path("/"), True, False), (Path("/srv"), False, True)]
