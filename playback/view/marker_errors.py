"""Measured markers in the scene, each with a line to where the arm has it."""

from collections.abc import Mapping

import numpy as np
import viser

from arm.marker_positions import marker_positions
from arm.model import Arm
from playback.measured_markers import MeasuredMarkers
from playback.shape import rgb
from playback.trajectory import Floats
from playback.view.figure import MARKER_RADIUS_M

#: Colour of what was measured, and of its distance from the model.
MEASURED, APART = rgb("2f9e5b"), rgb("c0392b")
#: Number of markers, those with the largest distances, that have a row of their own.
_N_WORST = 5


class MarkerErrors:
    """Draws measured markers beside those of an arm, and says how far they are apart.

    Parameters
    ----------
    server : viser.ViserServer
    arm : Arm
    trials : mapping of int to MeasuredMarkers
    """

    def __init__(self, server: viser.ViserServer, arm: Arm, trials: Mapping[int, MeasuredMarkers]) -> None:
        self._arm, self._trials = arm, trials
        self._apart_m: Floats = np.full(len(arm.markers), np.nan)
        self._points = server.scene.add_point_cloud(
            "/measured markers",
            np.zeros((0, 3)),
            MEASURED,
            point_size=2.0 * MARKER_RADIUS_M,
            point_shape="circle",
            precision="float32",
        )
        self._lines = server.scene.add_line_segments(
            "/marker errors",
            np.zeros((len(arm.markers), 2, 3)),
            APART,
            thickness=2.0,
            thickness_units="screen",
        )

    def show(self, trial: int | None, position_s: float, q: Floats) -> None:
        """Draw the markers of an instant of a trial, at which the arm is at q (n_joint,) [rad or m]."""
        modelled = marker_positions(self._arm, q[None])[0]
        known = None if trial is None else self._trials.get(trial)
        measured = np.full_like(modelled, np.nan) if known is None else known.at(position_s)
        seen = np.isfinite(measured[:, 0])
        self._apart_m = np.linalg.norm(measured - modelled, axis=1)
        self._points.points = measured[seen].astype(np.float32)
        ends = np.where(seen[:, None], measured, modelled)  # of one that was not seen the line has no length
        self._lines.points = np.stack([modelled, ends], axis=1).astype(np.float32)

    def seen(self, wanted: bool) -> None:
        """Say whether they are to be seen."""
        self._points.visible = self._lines.visible = wanted

    def rows(self) -> list[tuple[str, str]]:
        """Return what the panel says of the present: the rms, the markers farthest off, and how many are seen."""
        seen = np.flatnonzero(np.isfinite(self._apart_m))
        if not len(seen):
            return [("markers", "none is seen")]
        apart_mm = 1e3 * self._apart_m
        worst = seen[np.argsort(-apart_mm[seen])][:_N_WORST]
        rms = float(np.sqrt(np.mean(apart_mm[seen] ** 2)))
        return [
            (f"markers, {len(seen)} of {len(self._apart_m)}", f"{rms:.1f} mm rms"),
            *((self._arm.markers[m].name, f"{apart_mm[m]:.1f} mm") for m in worst.tolist()),
        ]
