"""The joints over time, drawn once, and where a time is in the drawing."""

from dataclasses import dataclass

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from playback.export.raster import Picture
from playback.export.sampled import Mover, Sampled
from playback.export.scene import PAPER
from playback.shape import Rgb
from playback.trajectory import Floats

INK, FAINT = "#30343b", "#d9dce3"


@dataclass(frozen=True)
class Plots:
    """A drawing of curves, and the way of a dot along each.

    Parameters
    ----------
    picture : ndarray of uint8 of shape (height, width, 3)
    x : ndarray of shape (n,)
        Of every frame [px].
    rows : list of (top, bottom)
        Of the plots [px].
    dots : list of (y, colour)
        Of every curve: y (n,) [px].
    """

    picture: Picture
    x: Floats
    rows: list[tuple[float, float]]
    dots: list[tuple[Floats, Floats]]


def draw_plots(motion: Sampled, width: int, height: int, head: int) -> Plots:
    """Draw every joint's position over time, in degrees or millimetres, a twin's beside the arm's.

    ``head`` is what is kept free above [px].
    """
    n_joint, dpi = motion.movers[0].arm.n_joint, 100.0 * min(1.0, height / 540.0)
    figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi, facecolor=_unit(PAPER))
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots(n_joint, 1, sharex=True, squeeze=False)[:, 0]
    margins = {"left": 62.0 / width, "right": 1.0 - 24.0 / width, "top": 1.0 - head / height}
    figure.subplots_adjust(**margins, bottom=0.52 * dpi / height, hspace=0.1)
    for j, ax in enumerate(axes):
        for mover in reversed(motion.movers):  # the arm's own curve lies on top
            style = {
                "color": _unit(mover.colours.trace),
                "linewidth": 1.6,
                "linestyle": "-" if mover is motion.movers[0] else "--",
            }
            ax.plot(motion.t, _shown(mover, j), **style)
        unit = "°" if motion.movers[0].arm.joints[j].type == "revolute" else "mm"
        ax.set_ylabel(f"$q_{{{j + 1}}}$ [{unit}]", color=INK, fontsize=10)
        ax.set_facecolor("white")
        ax.grid(color=FAINT, linewidth=0.7)
        ax.tick_params(colors=INK, labelsize=8, length=0)
        ax.locator_params(axis="y", nbins=4)
        ax.set_xlim(motion.t[0], max(motion.t[-1], 1e-3))
        for spine in ax.spines.values():
            spine.set_color(FAINT)
    axes[-1].set_xlabel("time [s]", color=INK, fontsize=10)
    canvas.draw()  # type: ignore[no-untyped-call]
    picture = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    picture = picture[:height, :width, :3].copy()
    rows, dots, x = [], [], np.empty(0)
    for j, ax in enumerate(axes):
        box = ax.get_window_extent()
        rows.append((height - box.y1, height - box.y0))
        for mover in reversed(motion.movers):
            seen = ax.transData.transform(np.column_stack([motion.t, _shown(mover, j)]))
            x = seen[:, 0]
            dots.append((height - seen[:, 1], np.array(mover.colours.trace, dtype=float)))
    return Plots(picture, x, rows, dots)


def _shown(mover: Mover, joint: int) -> Floats:
    q = mover.q[:, joint]
    return np.asarray(np.degrees(q) if mover.arm.joints[joint].type == "revolute" else 1e3 * q)


def _unit(colour: Rgb) -> tuple[float, float, float]:
    red, green, blue = colour
    return red / 255.0, green / 255.0, blue / 255.0
