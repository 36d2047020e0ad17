"""Results are those of one commit."""

from pathlib import Path

import pytest

from benchmarks import record


def test_a_commits_cases_are_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(record, "commit", lambda: "0123abc")
    path = tmp_path / "diagnosis-0123abc.jsonl"
    record.append(path, {"key": "one/cogging/3"})
    assert record.known_lines(path) == {"one/cogging/3": {"key": "one/cogging/3"}}


def test_results_of_code_without_a_commit_begin_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(record, "commit", lambda: "0123abc-dirty")
    path = tmp_path / "diagnosis-0123abc-dirty.jsonl"
    record.append(path, {"key": "one/cogging/3"})
    assert record.known_lines(path) == {}
    assert not path.exists()
