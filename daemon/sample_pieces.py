"""Cutting runs of samples into the pieces that a tracker takes, the same whatever the chunks they came in.

Two pieces make a block of `limb/raw`. Only the first is stamped by the device's clock, the other follows from it:
so a recording, which knows the time of its blocks alone, gives the same motion again bit for bit.
"""

from collections import deque

import numpy as np

from arm.model import Floats
from daemon.motion_blocks import RawSamples, later, raw_block_size
from daemon.reception import Run


class SamplePieces:
    """Cuts runs into half blocks; one is shorter where samples are missing after it.

    Parameters
    ----------
    rate_hz : float
    """

    def __init__(self, rate_hz: float) -> None:
        self._dt_s = 1.0 / rate_hz
        self._block = raw_block_size(rate_hz)
        self._half = (self._block + 1) // 2
        self._held: list[Floats] = []
        self._n_held = 0
        self._lost = 0
        self._sample = 0
        self._stamps: deque[tuple[int, int]] = deque()
        #: Of the block that is being cut: samples taken, and the time of its first.
        self._taken, self._block_ns = 0, 0

    def add(self, run: Run) -> list[RawSamples]:
        """Take a run; return the pieces that it completes."""
        pieces = self.flush() if run.lost else []
        if run.lost or not (self._n_held or self._taken):
            self._sample, self._taken = run.sample0, 0
            self._lost += run.lost
            self._stamps.clear()
        self._stamps.extend(run.stamps)
        self._held.append(run.a)
        self._n_held += len(run.a)
        while self._n_held >= self._next:
            pieces.append(self._cut(self._next))
        return pieces

    def flush(self) -> list[RawSamples]:
        """Return what is held as a piece of its own; what comes then begins a block."""
        pieces = [self._cut(self._n_held)] if self._n_held else []
        self._taken = 0
        return pieces

    @property
    def _next(self) -> int:
        """Samples of the next piece."""
        return min(self._half, self._block - self._taken)

    def _cut(self, n: int) -> RawSamples:
        a = np.concatenate(self._held) if len(self._held) > 1 else self._held[0]
        self._held = [a[n:]] if n < len(a) else []
        self._n_held -= n
        if self._taken == 0:
            self._block_ns = self._stamp()
        t0_ns = later(self._block_ns, self._taken, self._dt_s)
        piece = RawSamples(self._sample, t0_ns, self._dt_s, a[:n], self._lost)
        self._sample += n
        self._taken = (self._taken + n) % self._block
        self._lost = 0
        return piece

    def _stamp(self) -> int:
        """Return UTC [ns] of the next sample by the frame that it came in."""
        while len(self._stamps) > 1 and self._stamps[1][0] <= self._sample:
            self._stamps.popleft()
        sample, t_ns = self._stamps[0]
        return later(t_ns, self._sample - sample, self._dt_s)
