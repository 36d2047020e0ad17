"""Cases are kept as they are done, and those of this commit are not run again."""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from benchmarks import record
from benchmarks.case_pool import Line
from benchmarks.case_results import run_kept, show_page

OPTIONS = argparse.Namespace(workers=1, limit=60.0, json=True)


@dataclass(frozen=True)
class Case:
    number: int

    @property
    def key(self) -> str:
        return f"case {self.number}"


def squared(case: Case) -> Line:
    if case.number < 0:
        raise ValueError("below zero")
    return {"square": case.number**2}


@pytest.fixture
def results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(record, "RESULTS", tmp_path)
    monkeypatch.setattr(record, "commit", lambda: "abc")
    monkeypatch.setattr("benchmarks.case_results.commit", lambda: "abc")
    return tmp_path / "squares-abc.jsonl"


def test_a_case_that_is_known_is_not_run_again(results: Path) -> None:
    results.write_text(json.dumps({"key": "case 2", "square": "known"}) + "\n", encoding="utf-8")
    lines = run_kept("squares", [Case(2), Case(3)], squared, vars, OPTIONS)
    assert lines["case 2"]["square"] == "known"
    assert lines["case 3"] == {"number": 3, "key": "case 3", "commit": "abc", "square": 9}
    assert [json.loads(line)["key"] for line in results.read_text().splitlines()] == ["case 2", "case 3"]


def test_one_that_fails_says_why_and_the_others_go_on(results: Path) -> None:
    lines = run_kept("squares", [Case(-1), Case(1)], squared, vars, OPTIONS)
    assert "below zero" in lines["case -1"]["error"]
    assert lines["case 1"]["square"] == 1


def test_the_page_stands_beside_the_lines(results: Path) -> None:
    document = show_page("squares", [{"key": "case 1"}], "# Squares\n", OPTIONS)
    assert results.with_suffix(".md").read_text() == "# Squares\n"
    assert document == {"commit": "abc", "cases": [{"key": "case 1"}]}
