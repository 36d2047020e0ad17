"""What single channels read, and what they give away about their sensor.

That are readings at the end of the range, and none that move. Each count is looked at once for all of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled
from protocol.device_info import Channel

Counts = NDArray[np.int16]
Counted = NDArray[np.int64]

_LEAST, _MOST = np.iinfo(np.int16).min, np.iinfo(np.int16).max
#: The noise of a working accelerometer does not hold one count for this duration [s], nor, of a slow device, for
#: this number of samples: with a standard deviation of one count, once in 300 000 times. Conventions.
_FLAT_S, _FLAT_SAMPLES = 0.1, 10


@dataclass(frozen=True)
class Reading:
    """What channels read for a while; arrays are (n_channel,), in m/s^2 or samples.

    Attributes
    ----------
    samples : int
    mean, spread, noise : ndarray
        ``spread`` is the rms about the mean, ``noise`` that of white noise with the same second differences.
    saturated, clipped, flat : ndarray
        Samples beyond the declared range, at the ends of what 16 bits can say, and of a reading that stood still.
    """

    samples: int
    mean: Floats
    spread: Floats
    noise: Floats
    saturated: Counted
    clipped: Counted
    flat: Counted


class ChannelWatch:
    """Turns counts into what they are, and looks after each channel.

    It counts the samples at full scale, and those in which the reading had long stood still.

    A reading that stands still to the last count is a broken channel, not an arm at rest: that one shows noise.

    Attributes
    ----------
    saturated, flat : (n_channel,) int64
    """

    def __init__(self, channels: Sequence[Channel], rate_hz: float) -> None:
        self.saturated = np.zeros(len(channels), dtype=np.int64)
        self.flat = np.zeros(len(channels), dtype=np.int64)
        self._scale, self._offset = (
            np.array([getattr(c, name) for c in channels], dtype=np.float64) for name in ("scale", "offset")
        )
        limits = np.iinfo(np.int16)
        reach = np.array([(-c.full_scale - c.offset, c.full_scale - c.offset) for c in channels])
        ends = np.sort(reach / np.array([[c.scale] for c in channels]), axis=1)
        # Full scale may lie between two counts, or beyond what 16 bits can say.
        self._low = np.maximum(np.ceil(ends[:, 0]), limits.min).astype(np.int16)
        self._high = np.minimum(np.floor(ends[:, 1]), limits.max).astype(np.int16)
        self._flat_samples = max(round(_FLAT_S * rate_hz), _FLAT_SAMPLES)
        self._last = np.zeros(len(channels), dtype=np.int16)
        self._still = np.zeros(len(channels), dtype=np.int64)
        self._clear()
        self.watch(np.empty((0, len(channels)), dtype=np.int16))  # no sample is to wait for a compiler

    def watch(self, counts: Counts) -> Floats:
        """Take the next samples, (n_sample, n_channel); return what they are, in m/s^2."""
        n, a = len(counts), np.empty(counts.shape)
        _take_in(
            counts,
            self._scale,
            self._offset,
            self._low,
            self._high,
            self._flat_samples,
            self._last,
            self._still,
            self._sums,
            self.saturated,
            self._clipped,
            self.flat,
            a,
        )
        self._n += n
        self._bends += max(n - 2, 0)
        return a

    def take(self) -> Reading:
        """Return what the channels read since the last time.

        The noise is that of second differences, of which the motion of an arm has next to nothing.
        """
        n = max(self._n, 1)
        total, square, bend = self._sums
        mean = total / n
        spread = np.sqrt(np.maximum(square / n - mean**2, 0.0))
        noise = np.sqrt(bend / (6.0 * max(self._bends, 1)))
        reading = Reading(
            self._n,
            self._scale * mean + self._offset,
            np.abs(self._scale) * spread,
            np.abs(self._scale) * noise,
            self.saturated - self._saturated_before,
            self._clipped,
            self.flat - self._flat_before,
        )
        self._clear()
        return reading

    def _clear(self) -> None:
        self._n = self._bends = 0
        self._sums = np.zeros((3, len(self.flat)))
        self._clipped = np.zeros(len(self.flat), dtype=np.int64)
        self._saturated_before, self._flat_before = self.saturated.copy(), self.flat.copy()


@compiled
def _take_in(
    counts: Counts,
    scale: Floats,
    offset: Floats,
    low: Counts,
    high: Counts,
    flat_samples: int,
    last: Counts,
    still: Counted,
    sums: Floats,
    saturated: Counted,
    clipped: Counted,
    flat: Counted,
    a: Floats,
) -> None:
    """Fill in what counts are, and add them, their squares, those of their second differences, and the rest."""
    n = counts.shape[0]
    if n == 0:
        return
    for c in range(counts.shape[1]):
        was, lowest, highest, unit, zero = last[c], low[c], high[c], scale[c], offset[c]
        total = squares = bends = beyond = at_ends = changes = one = two = 0
        for k in range(n):
            count = int(counts[k, c])
            a[k, c] = unit * count + zero
            changes += count != was
            beyond += (count <= lowest) | (count >= highest)
            at_ends += (count <= _LEAST) | (count >= _MOST)
            total += count
            squares += count * count
            bend = count - 2 * one + two if k >= 2 else 0
            bends += bend * bend
            one, two = count, one
        sums[0, c] += total
        sums[1, c] += squares
        sums[2, c] += bends
        saturated[c] += beyond
        clipped[c] += at_ends
        # To the block: a channel that moved within it has been still since, at most, the block's beginning.
        still[c] = still[c] + n if changes == 0 else 0
        flat[c] += n if still[c] >= flat_samples else 0
        last[c] = counts[n - 1, c]
