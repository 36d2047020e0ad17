"""The plots under the time line: angles of both arms, and how far they are apart."""

from collections.abc import Sequence

import numpy as np
import viser
from viser import uplot

from arm.model import Arm
from playback.trajectory import Floats
from playback.view.feed import Row
from playback.view.remote import Motion

#: Points a line has: one for each pixel or so.
POINTS = 360
#: How much of a stream without an end is drawn [s].
LIVE_SPAN_S = 10.0
PALETTE = ("#2f5d8c", "#d9822b", "#3d9970", "#b04a5a", "#7b5ea7", "#8c6d46", "#5b8fa8", "#9aa23c")
CURSOR, FAINT = "#20262e", "#8a94a0"


class Timeline:
    """Two plots with a line at the present.

    Parameters
    ----------
    server : viser.ViserServer
        In whose present folder the plots are put.
    arm : Arm
    twin : bool
        Whether there is a second arm to compare with.
    """

    def __init__(self, server: viser.ViserServer, arm: Arm, twin: bool) -> None:
        self._arm, self._twin = arm, twin
        self._turns = np.array([joint.type == "revolute" for joint in arm.joints])
        unit = "°" if self._turns.all() else "° or mm"
        names = [f"q{k + 1}" for k in range(arm.n_joint)]
        series = [_line(name, PALETTE[k % len(PALETTE)]) for k, name in enumerate(names)]
        if twin:
            series += [_line(f"{name} twin", PALETTE[k % len(PALETTE)], dash=True) for k, name in enumerate(names)]
        self._angles = _plot(server, f"joints ({unit})", series, 190)
        self._errors = None
        if twin:
            lines = [_line(f"joints ({unit})", "#b04a5a"), _line("tip (mm)", "#3d9970")]
            self._errors = _plot(server, "between the two", lines, 130)
        self._lines: tuple[Floats, list[Floats], list[Floats]] | None = None

    def take(self, motion: Motion | None) -> None:
        """Draw a whole trial from now on, or, without one, what was heard last."""
        if motion is None or len(motion.t) < 2:
            self._lines = None
            return
        t = np.linspace(motion.t[0], motion.t[-1], min(POINTS, len(motion.t)))
        known = motion.twin_q is not None and motion.twin_tip is not None
        columns = [_at(t, motion.t, values) for values in (motion.q, motion.tip)]
        others = [_at(t, motion.t, values) for values in (motion.twin_q, motion.twin_tip) if values is not None]
        self._lines = self._curves(t, columns, others if known else None)

    def draw(self, position_s: float, rows: Sequence[Row]) -> None:
        """Draw both plots with the present at ``position_s`` [s]; ``rows`` is what was heard last."""
        lines = self._lines
        if lines is None:
            if len(rows) < 2:
                return
            rows = rows[:: max(1, len(rows) // POINTS)]
            columns = [np.array([row.real.q for row in rows]), np.array([row.real.tip for row in rows])]
            twins = [row.twin for row in rows if row.twin is not None]
            both = len(twins) == len(rows)
            others = [np.array([twin.q for twin in twins]), np.array([twin.tip for twin in twins])] if both else None
            lines = self._curves(np.array([row.position_s for row in rows]), columns, others)
        t, angles, errors = lines
        self._angles.data = _with_cursor(t, angles, position_s)
        if self._errors is not None:
            self._errors.data = _with_cursor(t, errors, position_s, zero=True)

    def remove(self) -> None:
        """Take the plots off the page."""
        self._angles.remove()
        if self._errors is not None:
            self._errors.remove()

    def _curves(
        self, t: Floats, columns: list[Floats], others: list[Floats] | None
    ) -> tuple[Floats, list[Floats], list[Floats]]:
        """Return time, joint values of both arms, and what is between the two."""
        scale = np.where(self._turns, np.degrees(1.0), 1e3)
        angles = list((columns[0] * scale).T)
        nothing = np.full(len(t), np.nan)
        if not self._twin:
            return t, angles, []
        if others is None:
            return t, angles + [nothing] * self._arm.n_joint, [nothing, nothing]
        apart = np.abs((columns[0] - others[0]) * scale).max(axis=1)
        tips = 1e3 * np.linalg.norm(columns[1] - others[1], axis=1)
        return t, angles + list((others[0] * scale).T), [apart, tips]


def _at(t: Floats, known_t: Floats, values: Floats) -> Floats:
    return np.column_stack([np.interp(t, known_t, column) for column in values.T])


def _with_cursor(t: Floats, lines: list[Floats], now: float, zero: bool = False) -> tuple[Floats, ...]:
    """Return the lines with an upright one at the present, as two points that are at the same time."""
    now = min(max(now, float(t[0])), float(t[-1]))
    k = int(np.searchsorted(t, now))
    drawn = [np.insert(line, k, [np.interp(now, t, line)] * 2) for line in lines]
    values = np.concatenate(lines)
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    cursor = np.full(len(t) + 2, np.nan)
    cursor[k : k + 2] = 0.0 if zero else low, high if high > low else low + 1.0
    return (np.insert(t, k, [now, now]), *drawn, cursor)


def _line(label: str, colour: str, dash: bool = False) -> uplot.Series:
    series = uplot.Series(label=label, stroke=colour, width=1.8, points={"show": False})
    if dash:
        series["dash"] = (5.0, 4.0)
        series["width"] = 1.4
    return series


def _plot(server: viser.ViserServer, title: str, series: list[uplot.Series], height: int) -> viser.GuiUplotHandle:
    cursor = uplot.Series(label="now", stroke=CURSOR, width=1.2, points={"show": False})
    t = np.array([0.0, 1.0])
    return server.gui.add_uplot(
        data=(t, *[np.full(2, np.nan) for _ in range(len(series) + 1)]),
        series=(uplot.Series(label="t (s)"), *series, cursor),
        scales={"x": uplot.Scale(time=False), "y": uplot.Scale(auto=True)},
        axes=(uplot.Axis(size=26.0), uplot.Axis(size=44.0)),
        legend=uplot.Legend(show=True, live=False),
        cursor=uplot.Cursor(show=False),
        title=title,
        height=height,
    )
