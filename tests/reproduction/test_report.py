"""The report of a reproduction."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from fitter.report.figures import png
from limbcal.errors import DeviceError, NotConverged
from reproduction.experiment import Experiment, Grid
from reproduction.report import document_of, write_report
from reproduction.reproduction import Outcome

GRID = Grid("A title", ("who", "a|b"), (("paper", 1.25), ("ours", None), ("x | y", "<b>")))


def outcomes() -> list[Outcome]:
    figure = Figure(figsize=(2, 1))
    figure.subplots().plot([0, 1])
    found = Experiment(
        "table6",
        "Table 6",
        ("It was assumed.",),
        (GRID,),
        (),
        ("It was found.",),
        {"x": np.arange(2), "y": np.nan},
    )
    return [
        Outcome("table6", found, ((png(figure), "A picture"),)),
        Outcome("fig8", None, error=NotConverged("no")),
    ]


def test_page_text_figures_and_pictures_are_written(tmp_path: Path):
    found = outcomes()
    write_report(found, document_of(found, 7), "fitter reproduce table6 fig8 --out DIR", tmp_path)
    text = (tmp_path / "reproduction.md").read_text()
    for line in (
        "| who | a\\|b |",
        "| paper | 1.25 |",
        "| ours | – |",
        "| x \\| y | <b> |",
        "![A picture](table6.png)",
    ):
        assert line in text.splitlines() or line in text
    assert "It was assumed." in text
    assert "**It was found.**" in text
    assert "Came to nothing: no" in text
    page = (tmp_path / "reproduction.html").read_text()
    assert "<td>&lt;b&gt;</td>" in page
    assert "data:image/png;base64," in page
    assert "http" not in page.replace("http-equiv", "")
    document = json.loads((tmp_path / "reproduction.json").read_text())
    assert document["seed"] == 7
    assert document["experiments"]["table6"]["x"] == [0, 1]
    assert document["experiments"]["table6"]["y"] is None
    assert document["experiments"]["fig8"] == {"error": "no"}
    assert (tmp_path / "table6.png").read_bytes().startswith(b"\x89PNG")


def test_a_place_that_cannot_be_written_is_a_device_error(tmp_path: Path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(DeviceError, match="cannot be written"):
        write_report(outcomes(), {}, "x", tmp_path / "file")
