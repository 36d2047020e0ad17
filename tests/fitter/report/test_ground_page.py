"""The page of a person's masses."""

import json

from tests.fitter.commands.test_ground_dynamics import dynamics, recorded

__all__ = ["recorded"]


def test_the_page_has_the_segments_and_the_ground(recorded, capsys):
    folder, theta = recorded
    page = folder / "page.html"
    assert dynamics(folder, ["learn.mot", "judge.mot"], "--prior", "regression", "--report", str(page)) == 0
    answer, text = json.loads(capsys.readouterr().out), page.read_text("utf-8")
    assert f"{answer['total_mass_kg']['value']:.2f} ±" in text and text.count("data:image/png") == 1
    for row in answer["segments"]:
        assert row["segment"] in text and f"{row['mass_kg']['value']:.3f}" in text
    assert "left at the prior" in text and "judge" in text and "learn.mot" in text
