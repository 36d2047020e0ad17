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

#: A simulation that is this far out has run away [rad or m].
_RUNAWAY = 1e3


@dataclass(frozen=True)
class Comparison:
    """One motion: t (n,) [s], angles measured and simulated (n, n_joint) [rad or m], which joints turn."""

    name: str
    learnt: bool
    t: Floats
    measured: Floats
    simulated: Floats
    turning: tuple[bool, ...]

    @property
    def shown(self) -> Floats:
        """What was simulated, NaN from where it ran away and would leave nothing else to be seen."""
        gone = ~(np.abs(self.simulated) < _RUNAWAY)
        return np.where(np.logical_or.accumulate(gone, axis=0), np.nan, self.simulated)

    @property
    def scale(self) -> Floats:
        """What turns radians into degrees and metres into millimetres, (n_joint,)."""
        return np.where(self.turning, np.rad2deg(1.0), 1e3)

    @property
    def error(self) -> Floats:
        """Errors of the joints that turn [deg]; where none does, of all [mm]: (n, joints)."""
        error: Floats = np.abs(self.shown - self.measured) * self.scale
        return error[:, self.turning] if any(self.turning) else error

    @property
    def unit(self) -> str:
        """Unit of `error`."""
        return "deg" if any(self.turning) else "mm"


def angles_figure(motions: Sequence[Comparison]) -> bytes:
    """Draw measured and simulated angles of all motions, one after the other: Fig. 7 over Fig. 8.

    Returns
    -------
    bytes
        PNG.
    """
    return png(draw_angles(motions))


def draw_angles(motions: Sequence[Comparison], labels: tuple[str, str] = ("measured", "simulated")) -> Figure:
    """Draw two sets of angles of all motions, one after the other, and how far they are apart."""
    n_joint = motions[0].measured.shape[1]
    figure = Figure(figsize=(12, 2.6 * n_joint + 1.6), layout="constrained")
    rows = figure.subplots(n_joint + 1, 1, sharex=True, height_ratios=[*[3] * n_joint, 1.6])
    start = 0.0
    for motion in motions:
        t = start + motion.t
        for joint in range(n_joint):
            first = start == 0.0
            rows[joint].plot(
                t,
                motion.measured[:, joint] * motion.scale[joint],
                color=MEASURED,
                lw=4.5,
                alpha=0.4,
                label=labels[0] if first else None,
            )
            rows[joint].plot(
                t,
                motion.shown[:, joint] * motion.scale[joint],
                color=SIMULATED,
                lw=1.0,
                label=labels[1] if first else None,
            )
        rows[-1].plot(t, motion.error.max(axis=1), color=ERROR, lw=0.8)
        start = float(t[-1])
    for joint in range(n_joint):
        rows[joint].set_ylabel(f"joint {joint + 1} [{'deg' if motions[0].turning[joint] else 'mm'}]")
        rows[joint].grid(alpha=0.25)
    rows[0].legend(loc="upper right", frameon=False, ncols=2)
    rows[-1].set_ylabel(f"error [{motions[0].unit}]")
    rows[-1].set_xlabel("time, motions one after the other [s]")
    rows[-1].grid(alpha=0.25)
    _mark_parts(rows, motions)
    return figure


def error_figure(motions: Sequence[Comparison]) -> bytes:
    """Draw each motion's mean and largest error of a simulated angle.

    Returns
    -------
    bytes
        PNG.
    """
    figure = Figure(figsize=(12, 2.8), layout="constrained")
    axes = figure.subplots()
    x = np.arange(1, len(motions) + 1)
    colours = [MEASURED if motion.learnt else SIMULATED for motion in motions]
    mean, worst = (np.array([f(motion.error) for motion in motions]) for f in (np.mean, np.max))
    is_finite = np.flatnonzero(np.isfinite(worst))  # no bar where the simulation ran away
    axes.bar(x[is_finite], mean[is_finite], color=[colours[k] for k in is_finite], width=0.6)
    axes.plot(x[is_finite], worst[is_finite], "v", color=ERROR, ms=5, label="largest")
    axes.set_xlim(0.4, len(motions) + 0.6)
    axes.set_xticks(x)
    axes.set_xlabel("motion (blue: learnt from, orange: evaluating)")
    axes.set_ylabel(f"error [{motions[0].unit}]")
    if np.any(worst > 0.0):
        axes.grid(alpha=0.25, axis="y")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0))
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
