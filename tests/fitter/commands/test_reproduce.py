"""`fitter reproduce`."""

import json
from pathlib import Path


def test_it_writes_what_it_prints(fitter, tmp_path: Path):
    outcome = fitter("reproduce", "table6", "--quick", "--seed", 3, "--out", tmp_path / "out")
    assert outcome.code == 0
    assert outcome.document == json.loads((tmp_path / "out" / "reproduction.json").read_text())
    assert outcome.document["seed"] == 3
    assert list(outcome.document["experiments"]) == ["table6"]
    text = (tmp_path / "out" / "reproduction.md").read_text()
    assert "`fitter reproduce table6 --out DIR --seed 3 --quick` makes this page." in text
    assert (tmp_path / "out" / "reproduction.html").exists()


def test_an_experiment_that_the_paper_does_not_have_is_a_mistake(fitter, tmp_path: Path):
    outcome = fitter("reproduce", "table7", "--out", tmp_path)
    assert outcome.code == 2
    assert "table7; there are table1, table2" in outcome.said


def test_a_file_is_no_directory(fitter, tmp_path: Path):
    (tmp_path / "file").write_text("x")
    outcome = fitter("reproduce", "table6", "--quick", "--out", tmp_path / "file")
    assert outcome.code == 3
    assert "file: no directory can be made there: it is a file" in outcome.said
