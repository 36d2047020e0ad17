"""A long motion in windows that overlap, so that its filters see in each what they would see in the whole.

A zero-phase filter looks both ways without end, but what it sees fades as fast as the slowest of its poles: after
a dozen periods of its corner it is less than what rounding leaves. A window is therefore read with a margin on
either side, filtered, and cut back.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from fitter.data.derivatives import HIGHEST_CORNER, ORDER

#: What a filter has forgotten to this share is forgotten.
FORGOTTEN = 1e-14
#: A quintic spline forgets an edge at least this fast; it halves every sample and more.
SPLINE_SAMPLES = 64


@dataclass(frozen=True)
class Window:
    """A stretch of samples; those from ``first`` to ``last`` count, the others are margin.

    Attributes
    ----------
    begin, end : int
        The window, as in a slice.
    first, last : int
        What of it counts, as in a slice.
    """

    begin: int
    end: int
    first: int
    last: int

    @property
    def all(self) -> slice:
        """The samples of the window."""
        return slice(self.begin, self.end)

    @property
    def counted(self) -> slice:
        """What counts, from the beginning of the window."""
        return slice(self.first - self.begin, self.last - self.begin)


def windows(seen: slice, counted: slice, portion: int, margin: int) -> Iterator[Window]:
    """Part samples into windows.

    Parameters
    ----------
    seen, counted : slice
        What there is, and what of it counts.
    portion : int
        How much a window counts; the last one also takes what would be left of no more than a margin.
    margin : int
        Samples on either side, where there are enough.
    """
    first = counted.start
    while first < counted.stop:
        last = first + portion
        if last + margin >= counted.stop:
            last = counted.stop
        yield Window(max(seen.start, first - margin), min(seen.stop, last + margin), first, last)
        first = last


def forgetting_samples(dt_s: float, *corners_hz: float) -> int:
    """Return how far an edge is seen through zero-phase filters with these corners, one after the other."""
    filters = [corner for corner in corners_hz if corner * dt_s < HIGHEST_CORNER]
    poles = [scipy.signal.butter(ORDER, corner, fs=1.0 / dt_s, output="zpk")[1] for corner in filters]
    return sum(math.ceil(math.log(FORGOTTEN) / math.log(np.abs(pole).max())) for pole in poles)
