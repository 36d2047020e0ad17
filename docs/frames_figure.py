"""Draw docs/frames.png: the frames of two links and the five numbers of eq. (1) that place them.

    .venv/bin/python docs/frames_figure.py

The picture is computed, not sketched: every point comes from the same factors as in `arm.kinematics`,
Rot(y, beta) Rot(x, alpha) Trans(0, 0, d) Rot(z, theta) Trans(a, 0, 0).
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Frame i-1 as it is seen: azimuth and elevation of the eye.
_AZIMUTH, _ELEVATION = np.deg2rad((-42.0, 38.0))
_RED, _GREEN, _BLUE, _INK, _PALE = "#c0392b", "#2e8b57", "#1f4e79", "#222222", "#8a8a8a"
_VIOLET, _ORANGE, _LINK = "#7d3c98", "#d07000", "#c9d6e3"

#: What is drawn; large angles, so that they are seen.
_ALPHA, _BETA, _D, _THETA, _A = np.deg2rad(-26.0), np.deg2rad(26.0), 1.15, np.deg2rad(58.0), 1.5


def rotation(axis: str, angle: float) -> Floats:
    """Return Rot(axis, angle), 4 by 4."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(4)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def translation(x: float, y: float, z: float) -> Floats:
    """Return Trans(x, y, z), 4 by 4."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


class Drawing:
    """A picture in space, in parallel projection."""

    def __init__(self, axes: Axes) -> None:
        self._axes = axes
        c, s, down = np.cos(_AZIMUTH), np.sin(_AZIMUTH), np.sin(_ELEVATION)
        self._view = np.array([[-s, c, 0.0], [-down * c, -down * s, np.cos(_ELEVATION)]])

    def seen(self, points: Floats) -> Floats:
        """Return where points (…, 3) are seen, (…, 2)."""
        places: Floats = points @ self._view.T
        return places

    def line(self, begin: Floats, end: Floats, color: str, width: float = 1.4, style: str = "-") -> None:
        """Draw a straight line."""
        x, y = self.seen(np.array([begin, end])).T
        self._axes.plot(x, y, color=color, lw=width, ls=style, solid_capstyle="round", zorder=2)

    def arrow(self, begin: Floats, end: Floats, color: str, width: float = 1.6, style: str = "-|>") -> None:
        """Draw an arrow."""
        p, q = self.seen(np.array([begin, end]))
        self._axes.add_patch(
            FancyArrowPatch(
                (p[0], p[1]), (q[0], q[1]), arrowstyle=style, mutation_scale=13, lw=width, color=color,
                shrinkA=0, shrinkB=0, zorder=4,
            )
        )  # fmt: skip

    def arc(
        self, frame: Floats, axis: str, start: float, end: float, radius: float, color: str, label: str
    ) -> None:
        """Draw an angle about an axis of a frame, counted as Rot counts it, from one direction to another."""
        first = {"x": "y", "y": "z", "z": "x"}[axis]
        unit = np.zeros(4)
        unit["xyz".index(first)] = radius
        unit[3] = 1.0
        points = np.array([(frame @ rotation(axis, t) @ unit)[:3] for t in np.linspace(start, end, 40)])
        x, y = self.seen(points).T
        self._axes.plot(x, y, color=color, lw=1.8, zorder=5)
        self._axes.add_patch(
            FancyArrowPatch(
                (x[-3], y[-3]), (x[-1], y[-1]), arrowstyle="-|>", mutation_scale=12, lw=0.0, color=color,
                shrinkA=0, shrinkB=0, zorder=5,
            )
        )  # fmt: skip
        unit["xyz".index(first)] = 1.22 * radius
        middle = self.seen((frame @ rotation(axis, 0.5 * (start + end)) @ unit)[:3])
        self.text_at(middle, label, color)

    def text(
        self, place: Floats, words: str, color: str, dx: float = 0.0, dy: float = 0.0, size: float = 12.0
    ) -> None:
        """Write at a point in space, moved by some of the picture's own units."""
        self.text_at(self.seen(place) + np.array([dx, dy]), words, color, size)

    def text_at(self, place: Floats, words: str, color: str, size: float = 13.0) -> None:
        """Write at a point of the picture."""
        self._axes.text(
            float(place[0]), float(place[1]), words, color=color, fontsize=size, ha="center", va="center", zorder=7
        )

    def triad(self, frame: Floats, index: str, length: float, names: str = "xyz", faint: bool = False) -> None:
        """Draw the axes of a frame."""
        origin = frame[:3, 3]
        for name, color in zip("xyz", (_RED, _GREEN, _BLUE), strict=True):
            if name in names:
                tip = origin + length * frame[:3, "xyz".index(name)]
                self.arrow(origin, tip, _PALE if faint else color, 1.1 if faint else 2.0)
                self.text(
                    origin + 1.13 * (tip - origin), f"${name}_{{{index}}}$", _PALE if faint else color, size=12
                )

    def dot(self, place: Floats, color: str = _INK) -> None:
        """Draw a point."""
        x, y = self.seen(place)
        self._axes.plot(x, y, "o", ms=6, color=color, zorder=6)


def draw() -> Figure:
    """Return the picture: any joint in space, and a flat arm of two joints."""
    figure = Figure(figsize=(12.0, 5.4), layout="constrained")
    in_space, flat = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    draw_joint(Drawing(in_space))
    draw_flat_arm(flat)
    titles = (
        "Frame $i$ from frame $i-1$:  Rot$(y,\\beta_i)$ Rot$(x,\\alpha_i)$ "
        "Trans$(0,0,d_i)$ Rot$(z,\\theta_i)$ Trans$(a_i,0,0)$",
        "A flat arm: $\\alpha_i = \\beta_i = d_i = 0$, only lengths are left",
    )
    for axes, title in zip((in_space, flat), titles, strict=True):
        axes.set_title(title, fontsize=11, color=_INK, pad=14)
        axes.set_aspect("equal", adjustable="datalim")
        axes.axis("off")
    return figure


def draw_joint(drawing: Drawing) -> None:
    """Draw two frames and what lies between them."""
    before = np.eye(4)
    turned_y = before @ rotation("y", _BETA)
    turned = turned_y @ rotation("x", _ALPHA)
    raised = turned @ translation(0.0, 0.0, _D)
    own = raised @ rotation("z", _THETA)
    far = own @ translation(_A, 0.0, 0.0)
    origin, axis = before[:3, 3], turned[:3, 2]
    drawing.line(np.array([-1.0, 0.0, 0.0]), origin, _LINK, 13)
    drawing.text(np.array([-0.75, 0.0, 0.0]), "link $i-1$", _BLUE, -0.1, -0.2, 11)
    drawing.line(-0.3 * axis, 1.9 * axis, _INK, 1.2, "-.")
    drawing.text(1.9 * axis, "axis of joint $i$", _INK, 0.38, -0.02, 11)
    drawing.line(own[:3, 3], far[:3, 3], _LINK, 13)
    drawing.text(own[:3, 3] + 0.85 * (far[:3, 3] - own[:3, 3]), "link $i$", _BLUE, 0.0, -0.2, 11)
    drawing.triad(before, "i-1", 0.85)
    drawing.triad(far, "i", 0.6)
    z_beta = turned_y[:3, 2]
    drawing.line(origin, 0.95 * z_beta, _PALE, 1.2, "--")
    drawing.arc(before, "y", 0.0, _BETA, 0.72, _VIOLET, r"$\beta_i$")
    drawing.arc(turned_y @ rotation("x", np.pi / 2), "x", 0.0, _ALPHA, 0.62, _ORANGE, r"$\alpha_i$")
    drawing.text(0.5 * _D * axis, "$d_i$", _INK, 0.13, -0.04, 14)
    drawing.arrow(origin, raised[:3, 3], _INK, 2.0, "<|-|>")
    drawing.arrow(own[:3, 3], far[:3, 3], _INK, 1.4, "<|-|>")
    drawing.text(0.55 * far[:3, 3] + 0.45 * own[:3, 3], "$a_i$", _INK, 0.0, 0.16, 14)
    drawing.line(raised[:3, 3], raised[:3, 3] + 0.72 * raised[:3, 0], _PALE, 1.2, "--")
    drawing.arc(raised, "z", 0.0, _THETA, 0.55, _RED, r"$\theta_i$")
    for place in (origin, raised[:3, 3], far[:3, 3]):
        drawing.dot(place)


def draw_flat_arm(axes: Axes) -> None:
    """Draw two links in the plane with their joints' angles and one sensor's place."""
    q1, q2, a1, a2 = np.deg2rad(28.0), np.deg2rad(42.0), 1.0, 1.05
    first = np.array([np.cos(q1), np.sin(q1)])
    second = np.array([np.cos(q1 + q2), np.sin(q1 + q2)])
    elbow = a1 * first
    tip = elbow + a2 * second
    for begin, end in ((np.zeros(2), elbow), (elbow, tip)):
        axes.plot(*np.array([begin, end]).T, color=_LINK, lw=13, solid_capstyle="round", zorder=1)
    for place, along, base in ((np.zeros(2), q1, 0.0), (elbow, q1 + q2, q1)):
        zero = place + 0.62 * np.array([np.cos(base), np.sin(base)])
        axes.plot(*np.array([place, zero]).T, color=_PALE, lw=1.2, ls="--")
        turn = np.linspace(base, along, 30)
        arc = place[:, None] + 0.42 * np.array([np.cos(turn), np.sin(turn)])
        axes.plot(*arc, color=_RED, lw=1.8)
        _head(axes, arc[:, -3], arc[:, -1], _RED, "-|>", 0.0)
        axes.plot(*place, "o", ms=13, mfc="white", mec=_INK, mew=2.0, zorder=6)
    for k, (place, middle) in enumerate(((np.zeros(2), q1 / 2), (elbow, q1 + q2 / 2)), 1):
        at = place + 0.54 * np.array([np.cos(middle), np.sin(middle)])
        _words(axes, at, f"$\\theta_{k}$", _RED)
    for begin, end, along, name, at in (
        (np.zeros(2), elbow, first, "$a_1$", 0.5),
        (elbow, tip, second, "$a_2$", 0.8),
    ):
        side = 0.13 * np.array([-along[1], along[0]])
        _head(axes, begin, end, _INK, "<|-|>", 1.4)
        _words(axes, (1.0 - at) * begin + at * end + side, name, _INK, 14)
    base = np.array([[0.42, 0.0], [0.0, 0.42]])
    for name, direction, color in zip("xy", base, (_RED, _GREEN), strict=True):
        _head(axes, np.zeros(2), direction * 1.5, color, "-|>", 2.0)
        _words(axes, direction * 1.68, f"${name}_0$", color)
    sensor = elbow + 0.62 * second
    side = 0.13 * np.array([-second[1], second[0]])
    axes.plot(*sensor, "s", ms=11, color=_ORANGE, zorder=7)
    _words(axes, sensor - 1.1 * side, "sensor", _ORANGE, 11)
    _head(axes, elbow + side, sensor + side, _ORANGE, "<|-|>", 1.4)
    _words(axes, elbow + 0.36 * second + 2.9 * side, "position_m\nalong x", _ORANGE, 10)
    axes.plot(*tip, "o", ms=6, color=_INK, zorder=6)
    _words(axes, tip + np.array([0.14, 0.0]), "tip", _INK, 11)
    _words(axes, np.array([-0.02, -0.17]), "joint 1", _INK, 10)
    _words(axes, elbow + np.array([0.2, -0.13]), "joint 2", _INK, 10)
    axes.set_xlim(-0.25, 1.6)


def _head(axes: Axes, begin: Floats, end: Floats, color: str, style: str, width: float) -> None:
    axes.add_patch(
        FancyArrowPatch(
            (begin[0], begin[1]), (end[0], end[1]), arrowstyle=style, mutation_scale=13, lw=width, color=color,
            shrinkA=0, shrinkB=0, zorder=5,
        )
    )  # fmt: skip


def _words(axes: Axes, place: Floats, words: str, color: str, size: float = 13.0) -> None:
    axes.text(
        float(place[0]), float(place[1]), words, color=color, fontsize=size, ha="center", va="center", zorder=8
    )


def main() -> None:
    """Write the picture."""
    figure = draw()
    FigureCanvasAgg(figure)
    figure.savefig(Path(__file__).with_name("frames.png"), dpi=130, metadata={"Software": None})


if __name__ == "__main__":
    main()
