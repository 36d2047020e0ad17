"""Means of readings over the samples of each frame, for a tracker that works sample by sample."""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.model.noise import noise_of

#: The noise is measured in the first readings [s].
_FIRST_S = 0.25


class FrameMeans:
    """Keeps readings until their frames are given out.

    Parameters
    ----------
    factor : int
        Samples a frame; frame k is made of those from ``k * factor`` on.
    n_channel : int
    rate_hz : float
        Of the samples.

    Attributes
    ----------
    noise : (2, n_channel) or None
        See `tracking.model.frames.Frames`; None until a quarter of a second was read.
    """

    def __init__(self, factor: int, n_channel: int, rate_hz: float) -> None:
        self._factor, self._rate_hz = factor, rate_hz
        self._kept: Floats = np.empty((0, n_channel))
        self._first = 0
        self._begin: Floats | None = np.empty((0, n_channel))
        self.noise: Floats | None = None

    def push(self, readings: Floats) -> None:
        """Take in readings, (n, n_channel)."""
        self._kept = np.concatenate([self._kept, readings])
        if self._begin is not None:
            self._begin = np.concatenate([self._begin, readings])
            if len(self._begin) >= max(8, _FIRST_S * self._rate_hz):
                self.noise = noise_of(self._begin, self._rate_hz).parts_of_mean(self._factor)
                self._begin = None

    def skip_to(self, sample: int) -> None:
        """Leave out the samples before this one."""
        self._kept, self._first = self._kept[:0], sample

    def means(self, frame: int, n: int) -> Floats:
        """Return the means of n frames from number ``frame`` on and forget them; NaN where none were read."""
        begin = frame * self._factor - self._first
        means = np.empty((n, self._kept.shape[1]))
        _mean_by_frame(self._kept, begin, self._factor, means)
        done = min(len(self._kept), max(0, begin + n * self._factor))
        self._kept, self._first = self._kept[done:], self._first + done
        return means


@compiled
def _mean_by_frame(readings: Floats, begin: int, factor: int, means: Floats) -> None:
    """Fill in the means of ``factor`` rows each, the first from row ``begin`` on, of those that are there."""
    for k in range(means.shape[0]):
        first = max(begin + k * factor, 0)
        end = min(begin + (k + 1) * factor, readings.shape[0])
        for c in range(means.shape[1]):
            means[k, c] = 0.0 if end > first else np.nan
        for row in range(first, end):
            for c in range(means.shape[1]):
                means[k, c] += readings[row, c]
        for c in range(means.shape[1]):
            means[k, c] /= max(end - first, 1)
