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
POINTS = 220
#: How much of a stream without an end is drawn [s].
LIVE_SPAN_S = 10.0
PALETTE = ("#2f5d8c", "#d9822b", "#3d9970", "#b04a5a", "#7b5ea7", "#8c6d46", "#5b8fa8", "#9aa23c")
NOW = "#20262e"


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
        lines = [(name, PALETTE[k % len(PALETTE)], False) for k, name in enumerate(names)]
        if twin:
            lines += [(f"{name} twin", PALETTE[k % len(PALETTE)], True) for k, name in enumerate(names)]
        self._angles = _Plot(server, f"joints ({unit})", lines, 210, zero=False)
        self._errors = None
        if twin:
            lines = [(f"joints ({unit})", "#b04a5a", False), ("tip (mm)", "#3d9970", False)]
            self._errors = _Plot(server, "apart", lines, 150, zero=True)
        self._drawn: object = None
        self._lines: tuple[Floats, list[Floats], list[Floats]] | None = None

    def take(self, motion: Motion | None) -> None:
        """Draw a whole trial from now on, or, without one, what was heard last."""
        self._drawn = None
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
        drawn = position_s, len(rows)
        if drawn == self._drawn:
            return
        self._drawn = drawn
        lines = self._lines
        if lines is None:
            if len(rows) < 2:
                return
            rows = rows[:: max(1, len(rows) // POINTS)]
            columns = [np.array([row.real.q for row in rows]), np.array([row.real.tip for row in rows])]
            twins = [row.twin for row in rows if row.twin is not None]
            both = len(twins) == len(rows)
            others = (
                [np.array([twin.q for twin in twins]), np.array([twin.tip for twin in twins])] if both else None
            )
            # where there is no end, time is counted back from the present, so that the axis stands still
            lines = self._curves(np.array([row.position_s for row in rows]) - position_s, columns, others)
        t, angles, errors = lines
        span = (float(t[0]), float(t[-1])) if self._lines is not None else (-LIVE_SPAN_S, 0.0)
        position_s = position_s if self._lines is not None else 0.0
        self._angles.draw(t, angles, position_s, span)
        if self._errors is not None:
            self._errors.draw(t, errors, position_s, span)

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
        nothing = np.zeros(len(t))
        if not self._twin:
            return t, angles, []
        if others is None:
            return t, angles + [nothing] * self._arm.n_joint, [nothing, nothing]
        apart = np.abs((columns[0] - others[0]) * scale).max(axis=1)
        tips = 1e3 * np.linalg.norm(columns[1] - others[1], axis=1)
        return t, angles + list((others[0] * scale).T), [apart, tips]


def _at(t: Floats, known_t: Floats, values: Floats) -> Floats:
    return np.column_stack([np.interp(t, known_t, column) for column in values.T])


class _Plot:
    """Lines over time, with an upright one at the present.

    That one is a line like the others: along the lower edge of the plot, and once up and down.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        title: str,
        names: Sequence[tuple[str, str, bool]],
        height: int,
        zero: bool,
    ) -> None:
        self._zero = zero
        self._range = self._span = (0.0, 1.0)
        series = [
            uplot.Series(label=name, stroke=colour, width=1.4 if dash else 1.8) for name, colour, dash in names
        ]
        for line, (_, _, dash) in zip(series, names, strict=True):
            line["points"] = {"show": False}
            if dash:
                line["dash"] = (5.0, 4.0)
        now = uplot.Series(label="now", stroke=NOW, width=1.2, points={"show": False})
        self._handle = server.gui.add_uplot(
            data=(np.array([0.0, 1.0]), *[np.zeros(2) for _ in range(len(series) + 1)]),
            series=(uplot.Series(label="t (s)"), *series, now),
            scales=self._scales(),
            axes=(uplot.Axis(size=34.0), uplot.Axis(size=42.0)),
            legend=uplot.Legend(show=True, live=False),
            cursor=uplot.Cursor(show=False),
            title=title,
            height=height,
        )

    def draw(self, t: Floats, lines: Sequence[Floats], now: float, span: tuple[float, float]) -> None:
        low, high = min(map(np.min, lines)), max(map(np.max, lines))
        if span != self._span or not self._holds(float(low), float(high)):
            self._range = _round_range(0.0 if self._zero else float(low), float(high))
            self._span = span
            self._handle.scales = self._scales()
        now = min(max(now, float(t[0])), float(t[-1]))
        k = int(np.searchsorted(t, now))
        drawn = [np.insert(line, k, [np.interp(now, t, line)] * 3) for line in lines]
        upright = np.full(len(t) + 3, self._range[0])
        upright[k + 1] = self._range[1]
        self._handle.data = (np.insert(t, k, [now] * 3), *drawn, upright)

    def remove(self) -> None:
        self._handle.remove()

    def _holds(self, low: float, high: float) -> bool:
        """Say whether lines fit and fill the range; another range is another plot, so it is kept if it can be."""
        bottom, top = self._range
        return bottom <= low and high <= top and (high - (0.0 if self._zero else low)) > 0.3 * (top - bottom)

    def _scales(self) -> dict[str, uplot.Scale]:
        return {"x": uplot.Scale(time=False, range=self._span), "y": uplot.Scale(range=self._range)}


def _round_range(low: float, high: float) -> tuple[float, float]:
    """Return a range with some room, and few digits."""
    span = max(high - low, 1e-6)
    step = 10.0 ** np.floor(np.log10(span)) / 2.0
    bottom = low if low == 0.0 else step * np.floor((low - 0.03 * span) / step)
    return float(bottom), float(step * np.ceil((high + 0.05 * span) / step))
