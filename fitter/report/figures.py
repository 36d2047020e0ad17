"""The pictures of a report: Fig. 7 and 8 in one, and where the error lives."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MEASURED, SIMULATED, ERROR = "#1f4e79", "#e07b00", "#a61c3c"


@dataclass(frozen=True)
class Comparison:
    """One motion, measured and simulated: t (n,) [s], angles (n, n_joint) [rad or m]."""

    name: str
    learnt: bool
    t: Floats
    measured: Floats
    simulated: Floats


def angles_figure(motions: Sequence[Comparison]) -> bytes:
    """Draw measured and simulated angles of all motions, one after the other: Fig. 7 over Fig. 8.

    Returns
    -------
    bytes
        PNG.
    """
    n_joint = motions[0].measured.shape[1]
    figure = Figure(figsize=(12, 2.6 * n_joint + 1.6), layout="constrained")
    rows = figure.subplots(n_joint + 1, 1, sharex=True, height_ratios=[*[3] * n_joint, 1.6])
    start, worst = 0.0, np.array([0.0])
    for motion in motions:
        t = start + motion.t
        error = np.abs(np.rad2deg(motion.simulated - motion.measured))
        for joint in range(n_joint):
            first = start == 0.0
            rows[joint].plot(
                t,
                np.rad2deg(motion.measured[:, joint]),
                color=MEASURED,
                lw=4.5,
                alpha=0.4,
                label="measured" if first else None,
            )
            rows[joint].plot(
                t,
                np.rad2deg(motion.simulated[:, joint]),
                color=SIMULATED,
                lw=1.0,
                label="simulated" if first else None,
            )
        rows[-1].plot(t, error.max(axis=1), color=ERROR, lw=0.8)
        worst = np.maximum(worst, error.max())
        start = float(t[-1])
    for joint in range(n_joint):
        rows[joint].set_ylabel(f"joint {joint + 1} [deg]")
        rows[joint].grid(alpha=0.25)
    rows[0].legend(loc="upper right", frameon=False, ncols=2)
    rows[-1].set_ylabel("error [deg]")
    rows[-1].set_xlabel("time, motions one after the other [s]")
    rows[-1].grid(alpha=0.25)
    _mark_parts(rows, motions)
    return png(figure)


def error_figure(motions: Sequence[Comparison]) -> bytes:
    """Draw each motion's mean and largest error of a simulated angle.

    Returns
    -------
    bytes
        PNG.
    """
    figure = Figure(figsize=(12, 2.8), layout="constrained")
    axes = figure.subplots()
    errors = [np.abs(np.rad2deg(motion.simulated - motion.measured)) for motion in motions]
    x = np.arange(1, len(motions) + 1)
    colours = [MEASURED if motion.learnt else SIMULATED for motion in motions]
    axes.bar(x, [error.mean() for error in errors], color=colours, width=0.6)
    axes.plot(x, [error.max() for error in errors], "v", color=ERROR, ms=5, label="largest")
    axes.set_xticks(x)
    axes.set_xlabel("motion (blue: learnt from, orange: evaluating)")
    axes.set_ylabel("error [deg]")
    axes.set_yscale("log")
    axes.grid(alpha=0.25, axis="y")
    axes.legend(frameon=False)
    return png(figure)


def png(figure: Figure) -> bytes:
    """Return a figure as the bytes of a PNG file that are the same for the same figure."""
    buffer = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(buffer, format="png", dpi=110, metadata={"Software": None})
    return buffer.getvalue()


def _mark_parts(rows: Sequence[Axes], motions: Sequence[Comparison]) -> None:
    """Shade part A, which was learnt from, and name both parts as the paper does."""
    learnt = sum(float(motion.t[-1]) for motion in motions if motion.learnt)
    total = sum(float(motion.t[-1]) for motion in motions)
    for axes in rows:
        if learnt:
            axes.axvspan(0.0, learnt, color=MEASURED, alpha=0.06, lw=0)
        axes.set_xlim(0.0, total)
    for x, text in ((0.0, "A: learning"), (learnt, "B: evaluating")):
        if x < total:
            rows[0].annotate(text, (x, 1.02), xycoords=("data", "axes fraction"), fontsize=9)
