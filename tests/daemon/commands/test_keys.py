"""`limbd keys`."""

import json
from pathlib import Path

import pytest

from daemon.__main__ import main
from protocol.curve import load_client_key


def test_a_client_gets_a_key_and_a_name_is_listed_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["keys", "new", "lab-pc", "--dir", "mine", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"client": "lab-pc", "key": "lab-pc.limbkey", "keys": "mine"}
    assert load_client_key(tmp_path / "lab-pc.limbkey")
    assert (tmp_path / "mine/clients/lab-pc.key").is_file()
    assert main(["keys", "new", "lab-pc", "--dir", "mine"]) == 2
    assert "lab-pc is let in already" in " ".join(capsys.readouterr().err.split())
