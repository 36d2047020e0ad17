"""The page of a diagnosis of the sensors."""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fitter.reading_diagnosis.sensor_verdict import SensorFinding
from fitter.report.page import Page
from limbcal.errors import DeviceError

_PICTURE = "diagnosis-sensors.png"
#: Points of a trace that are drawn.
_POINTS = 4000


def write_sensor_report(finding: SensorFinding, causes: Sequence[str], sentence: str, out: Path) -> None:
    """Write ``report.html`` and its picture.

    Parameters
    ----------
    finding : SensorFinding
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
    page = Page("Diagnosis of the sensors", sentence)
    picture = course_figure(finding)
    try:
        (out / _PICTURE).write_bytes(picture)
    except OSError as error:
        raise DeviceError(f"{out / _PICTURE}: cannot be written: {error.strerror}") from error
    page.picture(picture, "What no motion of a rigid arm explains, before and with the causes, evaluating trials.")
    if causes:
        page.section("Why")
        page.points(causes)
    page.section("What it gains")
    page.table(
        ("sensor", "before [m/s²]", "after [m/s²]"),
        [(name, was, finding.after[name]) for name, was in finding.before.items()],
    )
    page.section("The rivals", "Share of the contradiction that each takes away on trials it was not fitted to.")
    page.table(
        ("effect", "sensor", "share", "support"),
        [(one.effect, ", ".join(one.sensors), one.gain, one.support) for one in finding.candidates[:12]],
    )
    residual = finding.residual
    depends = f" It depends on {', '.join(residual.depends_on)}." if residual.depends_on else ""
    page.section("What is left", f"{'No more than noise.' if residual.white else 'More than noise.'}{depends}")
    page.section("The next experiment", finding.next_experiment)
    page.write(out / "report.html")


def course_figure(finding: SensorFinding) -> bytes:
    """Draw what contradicts a rigid arm, a row a sensor, as PNG."""
    course = finding.course
    names = list(finding.before)
    figure = Figure(figsize=(10.0, 1.8 * max(1, len(names))), layout="constrained")
    FigureCanvasAgg(figure)
    step = max(1, len(course.t) // _POINTS)
    for k, name in enumerate(names):
        axes = figure.add_subplot(len(names), 1, k + 1)
        for values, colour, label in ((course.before, "#a61c3c", "before"), (course.after, "#1f4e79", "after")):
            size = np.sqrt(np.sum(values[::step, k] ** 2, axis=1))
            axes.plot(course.t[::step], size, color=colour, linewidth=0.7, label=label)
        axes.set_ylabel(f"{name} [m/s²]")
    figure.axes[0].legend(loc="upper right", frameon=False)
    figure.axes[-1].set_xlabel("run's time [s]")
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=110)
    return picture.getvalue()
