"""Windows of a long recording: each is smoothed by itself, from the state in which the one before it ended.

A pass over a recording keeps some thousand bytes an instant, so that hours would not fit into memory. A window
ends where its readings change least, in a rest if there is one, and is smoothed with some seconds of what follows:
later readings say next to nothing of its motion. What they say of constants the windows after it have.
"""

from typing import NamedTuple

import numpy as np

from arm.model import Floats
from tracking.model.readings import Readings
from tracking.model.zero_velocity import window_frames

#: Instants of a window [frames]: with four sensors on two joints 3.5 kB each, and 9 kB where their mountings are
#: sought too.
LONGEST = 100_000
#: A window may be longer or shorter by this part, so that it ends where the arm rests.
_LEEWAY = 0.2
#: By how much more is smoothed than is kept [s]: thirty times as long as what a model lacks may last, forty times
#: as long as readings are averaged over to show a rest.
LOOK_AHEAD_S = 10.0


class Window(NamedTuple):
    """The frames from ``begin`` up to ``end``, and those up to ``ahead`` that are smoothed with them."""

    begin: int
    end: int
    ahead: int

    def of(self, readings: Readings) -> Readings:
        """Return the readings of a window and of what is smoothed with it."""
        start_s = readings.t0_s + self.begin * readings.dt_s
        own = readings.values[self.begin : self.ahead]
        return Readings(own, readings.dt_s, start_s, readings.noise, readings.factor)


def windows_of(readings: Readings, longest: int = LONGEST, ahead_s: float = LOOK_AHEAD_S) -> list[Window]:
    """Part a recording; one that is not much longer than a window is one.

    Parameters
    ----------
    readings : Readings
    longest : int, optional
        Instants of a window, give or take a fifth.
    ahead_s : float, optional
        By how much more is smoothed than is kept.
    """
    n, begin, windows = len(readings.values), 0, list[Window]()
    more = round(ahead_s / readings.dt_s)
    least, most = (round((1.0 + sign * _LEEWAY) * longest) for sign in (-1.0, 1.0))
    while n - begin > most + more:
        end = begin + least + _calmest(readings.values[begin + least :], most - least, readings.dt_s)
        windows.append(Window(begin, end, min(end + more, n)))
        begin = end
    return [*windows, Window(begin, n, n)]


def _calmest(values: Floats, within: int, dt_s: float) -> int:
    """Return the frame among the first ones after which readings change least for a while; not in a gap.

    Where nothing was read in any of them, that is the first one of all that was read.
    """
    cell, n_cell = window_frames(dt_s)
    length = cell * n_cell
    starts = np.arange(0, len(values) - length, length)
    there = np.isfinite(values[: len(starts) * length, 0]).reshape(-1, length).all(axis=1)
    near = there & (starts < within)
    if not near.any():
        return int(starts[np.argmax(there)]) if there.any() else len(values) - 1
    parts = values[: np.count_nonzero(starts < within) * length].reshape(-1, length, values.shape[1])
    scatter = np.where(near[: len(parts)], parts.std(axis=1).max(axis=1), np.inf)
    return int(starts[np.argmin(scatter)])
