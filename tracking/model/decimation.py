"""From the sensors' rate to the filter's: a linear-phase low-pass, evaluated where a frame falls due."""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Frames that the low-pass reaches over, and its corner as a share of the highest frequency that frames can hold.
_REACH, _CORNER = 3, 0.9
#: Shape of the Kaiser window [1]: its side lobes are 54 dB down (Oppenheim and Schafer, Discrete-Time Signal
#: Processing, section 7.5.3: 0.1102 (A - 8.7) for an attenuation of A dB).
_KAISER = 5.0


class Decimator:
    """Low-passes readings and keeps every so-manieth; what it gives out does not depend on how blocks are cut.

    Frame k is centred on sample ``k * factor + factor // 2``. Where readings begin or end, the first or last one
    stands in for what is beyond.

    Parameters
    ----------
    factor : int
        Samples a frame. With 1 nothing is filtered.
    n_channel : int
    """

    def __init__(self, factor: int, n_channel: int) -> None:
        self.factor = factor
        half = _REACH * factor // 2 if factor > 1 else 0
        self._taps = _low_pass(half, _CORNER / factor)
        self._half = half
        self._n_channel = n_channel
        self._kept = np.empty((0, n_channel))
        self._first = 0  # number of the first sample kept
        self._next = 0  # number of the next frame
        self._begun = False

    @property
    def delay_samples(self) -> int:
        """How many samples after its own a frame can be given out."""
        return self._half

    def push(self, readings: Floats) -> Floats:
        """Take in readings (n, n_channel); return the frames that they complete (m, n_channel)."""
        if len(readings) and not self._begun:
            readings = np.vstack([np.repeat(readings[:1], self._half, axis=0), readings])
            self._first -= self._half
            self._begun = True
        centre, count = self._centre - self._first, self.completes(len(readings))
        self._kept = np.concatenate([self._kept, readings])
        frames = np.empty((count, self._n_channel))
        _filter(self._kept, self._taps, centre - self._half, self.factor, frames)
        self._next += count
        keep = min(len(self._kept), max(0, centre + count * self.factor - self._half))
        self._kept, self._first = self._kept[keep:], self._first + keep
        return frames

    def completes(self, n: int) -> int:
        """Return how many frames the next ``n`` readings will complete, once it has begun."""
        return max(0, (self._first + len(self._kept) + n - 1 - self._half - self._centre) // self.factor + 1)

    @property
    def _centre(self) -> int:
        """Number of the sample in the middle of the next frame."""
        return self._next * self.factor + self.factor // 2

    def flush(self) -> Floats:
        """Return the frames whose own sample has come but not what follows it, and begin anew behind them."""
        if not self._begun:
            return np.empty((0, self._n_channel))
        end = self._first + len(self._kept)
        frames = self.push(np.repeat(self._kept[-1:], self._half, axis=0))
        self._kept, self._first, self._begun = self._kept[:0], end, False
        return frames

    def skip(self, n_samples: int) -> int:
        """Leave samples out after a `flush`; return how many frames are left out with them."""
        self._first += n_samples
        due = max(0, -(-(self._first - self.factor // 2) // self.factor))  # the first frame centred on what comes
        skipped, self._next = due - self._next, due
        return skipped


def _low_pass(half: int, corner: float) -> Floats:
    """Return an ideal low-pass behind a Kaiser window; its sum is 1, so gravity passes as it is.

    Parameters
    ----------
    half : int
        Taps on either side of the middle one.
    corner : float
        As a share of the highest frequency that readings can hold.
    """
    taps = np.sinc(corner * np.arange(-half, half + 1)) * np.kaiser(2 * half + 1, _KAISER)
    return np.asarray(taps / taps.sum(), dtype=np.float64)


@compiled
def _filter(readings: Floats, taps: Floats, first: int, step: int, frames: Floats) -> None:
    for k in range(frames.shape[0]):
        begin = first + k * step
        for c in range(frames.shape[1]):
            frames[k, c] = 0.0
        for i in range(taps.size):
            for c in range(frames.shape[1]):  # innermost, so that channels are summed side by side
                frames[k, c] += taps[i] * readings[begin + i, c]
