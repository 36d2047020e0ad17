"""What single channels give away about their sensor: readings at the end of the range, and none that move."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from protocol.serial_frame import Channel

Counts = NDArray[np.int16]

#: A living accelerometer's noise never holds one count for so long.
_FLAT_S = 0.1


class ChannelWatch:
    """Counts, per channel, the samples at full scale and those in which the reading had long stood still.

    Attributes
    ----------
    saturated, flat : (n_channel,) int64
    """

    def __init__(self, channels: Sequence[Channel], rate_hz: float) -> None:
        self.saturated = np.zeros(len(channels), dtype=np.int64)
        self.flat = np.zeros(len(channels), dtype=np.int64)
        limits = np.iinfo(np.int16)
        reach = np.array([(-c.full_scale - c.offset, c.full_scale - c.offset) for c in channels])
        ends = np.sort(reach / np.array([[c.scale] for c in channels]), axis=1)
        # Full scale may lie between two counts, or beyond what 16 bits can say.
        self._low = np.maximum(np.ceil(ends[:, 0]), limits.min).astype(np.int16)
        self._high = np.minimum(np.floor(ends[:, 1]), limits.max).astype(np.int16)
        self._flat_samples = round(_FLAT_S * rate_hz)
        self._last = np.zeros(len(channels), dtype=np.int16)
        self._still = np.zeros(len(channels), dtype=np.int64)

    def watch(self, counts: Counts) -> None:
        """Take the next samples, (n_sample, n_channel)."""
        self.saturated += np.count_nonzero((counts <= self._low) | (counts >= self._high), axis=0)
        held = np.all(counts == self._last, axis=0)
        # To the block: a channel that moved within it has been still since, at most, the block's beginning.
        self._still = np.where(held, self._still + len(counts), 0)
        self.flat += np.where(self._still >= self._flat_samples, len(counts), 0)
        self._last = counts[-1].copy()
