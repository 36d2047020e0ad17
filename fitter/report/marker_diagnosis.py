"""The page of a diagnosis of a person's markers."""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fitter.marker_diagnosis.marker_finding import MarkerFinding
from fitter.report.page import Page
from limbcal.errors import DeviceError

_PICTURE = "diagnosis-markers.png"
#: Candidates that the page lists.
_LISTED = 12


def write_marker_report(finding: MarkerFinding, causes: Sequence[str], sentence: str, out: Path) -> None:
    """Write ``report.html`` and its picture.

    Parameters
    ----------
    finding : MarkerFinding
    causes : sequence of str
        In plain words.
    sentence : str
        The verdict in plain words.
    out : Path

    Raises
    ------
    DeviceError
        If a file cannot be written.
    """
    page = Page("Diagnosis of the markers", sentence)
    picture = distances_figure(finding)
    try:
        (out / _PICTURE).write_bytes(picture)
    except OSError as error:
        raise DeviceError(f"{out / _PICTURE}: cannot be written: {error.strerror}") from error
    page.picture(picture, "Every marker's rms distance from the motion [mm], trial by trial, before and after.")
    if causes:
        page.section("Why")
        page.points(causes)
    page.section("What it gains")
    rows = [
        ("all markers", *finding.rms_mm),
        *((name, was, finding.after[name]) for name, was in finding.before.items()),
    ]
    page.table(("marker", "before [mm]", "after [mm]"), rows)
    page.section("The rivals", "By the log of how much likelier each makes the markers' mean errors.")
    page.table(
        ("effect", "markers", "evidence [nats]"),
        [
            (one.tried.effect.name, ", ".join(one.tried.effect.markers), one.tried.evidence)
            for one in finding.candidates[:_LISTED]
        ],
    )
    page.section(
        "What remains",
        f"Sound markers' mean errors are {finding.wander:.2f} times what the arm file says that markers wander.",
    )
    page.section("The next experiment", finding.next_experiment)
    page.write(out / "report.html")


def distances_figure(finding: MarkerFinding) -> bytes:
    """Draw markers' distances, a row a trial, as PNG."""
    names = list(finding.before)
    n = len(finding.by_trial)
    figure = Figure(figsize=(10.0, 1.2 + 1.5 * n), layout="constrained")
    FigureCanvasAgg(figure)
    at = np.arange(len(names))
    for k, (label, before, after) in enumerate(finding.by_trial):
        axes = figure.add_subplot(n, 1, k + 1)
        axes.bar(at - 0.2, before, 0.4, color="#a61c3c", label="before")
        axes.bar(at + 0.2, after, 0.4, color="#1f4e79", label="after")
        axes.set_ylabel(f"{label}\n[mm]")
        axes.set_xticks(at, names if k == n - 1 else [""] * len(names), rotation=90)
    figure.axes[0].legend(loc="upper right", frameon=False)
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=110)
    return picture.getvalue()
