"""`limbd recover`."""

from pathlib import Path

import pytest

from daemon.__main__ import main


def test_a_file_and_where_its_copy_goes_are_passed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []
    monkeypatch.setattr("daemon.recording.recovery.recover", lambda *what: asked.append(what) or {})
    cut, out = tmp_path / "cut.mcap", tmp_path / "clean.mcap"
    assert main(["recover", str(cut)]) == main(["recover", str(cut), "--out", str(out)]) == 0
    assert asked == [(cut, None), (cut, out)]


def test_a_file_that_is_not_there_is_a_mistake(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["recover", str(tmp_path / "none.mcap")]) == 2
    assert "none.mcap" in capsys.readouterr().err
