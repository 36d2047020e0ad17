"""What arrivals tell of the rate of a device's clock, in spite of all delays.

A block of samples cannot arrive before it was taken, and of all the delays on its way the shortest is much the
same at any time. So of each stretch of time the arrival that was least late counts, and a straight line through
those,

    m = b + r d,

with the device's seconds d and the host's m, gives the rate r and the offset b: least squares, and once more
without those that lie further from it than three times the median distance. Stretches are short at first, so that
a line is there after a quarter of a second, and are joined two by two as they become many.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from daemon.clock.tick_step import MAD_TO_STD

#: The first stretches, and how long they grow before there are many, and at last [s].
_FIRST_S, _LONG_S, _LONGEST_S = 1.0 / 16.0, 1.0, 4.0
#: How many there are at the most while they are short, so that each holds many arrivals, and then: of the last
#: nine to seventeen minutes.
_SHORT_KEPT, _KEPT = 16, 256
#: Least number of stretches for a line.
_FEW = 4
#: Standard deviations, by the median, from which a point is no part of the line: by chance one in 370.
_OUTLIER = 3.0
#: The reader gathers bytes for 6 ms, and a busy host lets it wait for a few more; all arrivals of a stretch may
#: wait for so long [s]. That is the same for many stretches, which least squares know nothing of, so it counts as
#: three standard deviations.
_WAITED_S = 0.010


@dataclass(frozen=True)
class Line:
    """A line through the least late arrivals.

    Attributes
    ----------
    rate : float
        Host's seconds in one of the device's.
    scatter_std : float
        Of the rate, by the scatter of the arrivals alone.
    rate_std : float
        Of the rate, with what all of them may have had to wait.
    device_s, host_s : float
        The middle of the arrivals, through which it goes.
    spread_s : float
        Of the arrivals about it.
    span_s : float
        From the first of them to the last.
    """

    rate: float
    scatter_std: float
    rate_std: float
    device_s: float
    host_s: float
    spread_s: float
    span_s: float


class LeastLate:
    """Keeps the least late arrival of each stretch.

    Parameters
    ----------
    rate : float
        By which lateness is judged while there is no line.
    """

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._stretch_s = _FIRST_S
        self._points: list[tuple[float, float]] = []
        self._best: tuple[float, float] | None = None
        self._until_s = 0.0

    def note(self, device_s: float, host_s: float) -> bool:
        """Note an arrival; return whether that was the last of a stretch."""
        if self._best is None:
            self._until_s = device_s + self._stretch_s
        if self._best is None or self._late(device_s, host_s) <= self._late(*self._best):
            self._best = device_s, host_s
        if device_s < self._until_s:
            return False
        self._points.append(self._best)
        self._best = None
        most = _SHORT_KEPT if self._stretch_s < _LONG_S else _KEPT
        if len(self._points) >= most and self._stretch_s < _LONGEST_S:
            pairs = zip(self._points[::2], self._points[1::2], strict=True)
            self._points = [min(pair, key=lambda point: self._late(*point)) for pair in pairs]
            self._stretch_s *= 2.0
        del self._points[:-_KEPT]
        return True

    def line(self) -> Line | None:
        """Return the line; None while too little has come."""
        if len(self._points) < _FEW:
            return None
        device, host = np.array(self._points).T
        line = _line(device, host)
        if line is not None:
            self._rate = line.rate
        return line

    def _late(self, device_s: float, host_s: float) -> float:
        return host_s - self._rate * device_s


def _line(device: Floats, host: Floats) -> Line | None:
    """Return the line through all but outliers."""
    off = host - device
    near = np.ones(len(device), dtype=bool)
    for last in (False, True):
        x, y = device[near], off[near]
        middle, height = x.mean(), y.mean()
        lever = np.sum((x - middle) ** 2)
        if lever <= 0.0:
            return None
        slope = np.sum((x - middle) * y) / lever
        distance = off - height - slope * (device - middle)
        size = np.abs(distance)
        beyond = size > _OUTLIER * MAD_TO_STD * np.median(size) + 1e-12
        if last or not beyond.any() or len(device) - np.count_nonzero(beyond) < _FEW - 1:
            break
        near = ~beyond
    spread = float(np.sqrt(np.sum(distance[near] ** 2) / max(np.count_nonzero(near) - 2, 1)))
    span = float(device[-1] - device[0])
    scatter = float(spread / np.sqrt(lever))
    std = float(np.hypot(scatter, _WAITED_S / 3.0 / span))
    return Line(1.0 + float(slope), scatter, std, float(middle), float(middle + height), spread, span)
