"""The first-order high-pass of AC-coupled sensors: what lasts is forgotten.

With corner f and ``wc = 2 pi f``, a slow copy l of the reading x is taken off it:

    l' = wc (x - l),    y = x - l

Between two samples, ``h`` apart, x is taken to run straight; for such x the step is exact at any corner:

    l += (1 - E) (x_before - l) + (1 - (1 - E) / (wc h)) (x - x_before),    E = exp(-wc h)

for a ramp ``x_before + s t`` has the solution ``l = x_before + s t - s / wc``, and what l is away from it at the
start of the step fades by E. The sensor has been on for long when its first reading comes, so l begins there and
the first y is 0.
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled


class HighPass:
    """One high-pass a channel, carried from block to block: how the readings are cut makes no difference.

    Parameters
    ----------
    corner_hz : (n_channel,)
        0 for a channel that is to stay as it is.
    rate_hz : float
        Of the samples.
    """

    def __init__(self, corner_hz: Floats, rate_hz: float) -> None:
        angle = 2.0 * np.pi * np.asarray(corner_hz, dtype=float) / rate_hz
        self._fade = -np.expm1(-angle)
        self._follow = 1.0 - np.divide(self._fade, angle, out=np.ones_like(angle), where=angle > 0.0)
        self._before: Floats | None = None
        self._low = np.zeros_like(angle)

    def apply(self, readings: Floats) -> None:
        """Replace readings (n_sample, n_channel), which follow those before them, by what passes."""
        if not len(readings):
            return
        if self._before is None:
            self._before = readings[0].copy()
            self._low = readings[0].copy()
        _high_pass(self._fade, self._follow, self._before, self._low, readings)


@compiled
def _high_pass(fade: Floats, follow: Floats, before: Floats, low: Floats, readings: Floats) -> None:
    for k in range(readings.shape[0]):
        for c in range(fade.size):
            if fade[c] == 0.0:
                continue
            x = readings[k, c]
            low[c] += fade[c] * (before[c] - low[c]) + follow[c] * (x - before[c])
            before[c] = x
            readings[k, c] = x - low[c]
