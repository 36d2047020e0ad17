"""The way that a tip came, fading into the background."""

from collections.abc import Sequence

import numpy as np
import viser

from playback.trajectory import Floats
from playback.view.stage import BACKGROUND

#: Pieces of a trace, 75 a second: about one a picture.
SEGMENTS = 90
#: How long a trace looks back, in seconds of the motion.
SPAN_S = 1.2


class Trace:
    """A line behind a tip, as many segments long as ever, so that only its points are sent anew.

    Parameters
    ----------
    server : viser.ViserServer
    name : str
    colour : tuple of int
    """

    def __init__(self, server: viser.ViserServer, name: str, colour: tuple[int, int, int]) -> None:
        share = np.linspace(0.0, 1.0, SEGMENTS + 1)[:, None]
        fading = (1.0 - share) * np.array(BACKGROUND) + share * np.array(colour)
        self._line = server.scene.add_line_segments(
            name,
            np.zeros((SEGMENTS, 2, 3)),
            _pairs(fading).astype(np.uint8),
            thickness=3.0,
            thickness_units="screen",
            visible=False,
        )
        self.wanted = True

    def show(self, t: Sequence[float], tips: Sequence[Floats]) -> None:
        """Draw the line through tips, oldest first; ``t`` [s], rising, and rows of (3,) [m]."""
        self._line.visible = self.wanted and len(t) > 1
        if not self._line.visible:
            return
        path, at = np.array(tips), np.array(t)
        wanted = np.linspace(at[-1] - SPAN_S, at[-1], SEGMENTS + 1)
        points = np.column_stack([np.interp(wanted, at, path[:, k]) for k in range(3)])
        self._line.points = _pairs(points).astype(np.float32)

    def stand_at(self, place: Floats) -> None:
        """Move the line as its arm's base is moved, (3,) [m]."""
        self._line.position = place

    def remove(self) -> None:
        """Take the line off the scene."""
        self._line.remove()


def _pairs(rows: Floats) -> Floats:
    return np.stack([rows[:-1], rows[1:]], axis=1)
