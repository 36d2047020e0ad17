"""Cutting runs of samples into blocks of 10 ms, the same whatever the chunks that they came in.

A block is what the tracker is given, what `limb/raw` sends and what is recorded, and it is stamped once, by the
frame that its first sample came in: so a recording gives the same motion again bit for bit. Where a frame holds
several blocks and the stamps of the next frame wait for arrivals, the blocks' stamps wait, too: none goes back.
"""

from collections import deque

import numpy as np

from arm.model import Floats
from daemon.clock.stamp_line import WAITING
from daemon.publishing.motion_blocks import RawSamples, later, raw_block_size
from daemon.reception.sample_runs import FrameTimes, Run


class SampleBlocks:
    """Cuts runs into blocks; one is shorter where samples are missing after it.

    Parameters
    ----------
    rate_hz : float
        About the device's: a block has as many samples as this makes in 10 ms.
    """

    def __init__(self, rate_hz: float) -> None:
        self._size = raw_block_size(rate_hz)
        self._held: list[Floats] = []
        self._n_held = 0
        self._lost = 0
        self._sample = 0
        self._earliest_ns = 0
        self._times: deque[FrameTimes] = deque()

    def add(self, run: Run) -> list[RawSamples]:
        """Take a run; return the blocks that it completes."""
        blocks = self.flush() if run.lost else []
        if not self._n_held:
            self._sample = run.sample0
            self._lost += run.lost
            self._times.clear()
        self._times.extend(run.times)
        self._held.append(run.a)
        self._n_held += len(run.a)
        if self._n_held >= self._size and len(self._held) > 1:
            self._held = [np.concatenate(self._held)]
        while self._n_held >= self._size:
            blocks.append(self._cut(self._size))
        return blocks

    def flush(self) -> list[RawSamples]:
        """Return what is held as a block of its own."""
        if not self._n_held:
            return []
        self._held = [np.concatenate(self._held)]
        return [self._cut(self._n_held)]

    def _cut(self, n: int) -> RawSamples:
        (a,) = self._held
        while len(self._times) > 1 and self._times[1].sample0 <= self._sample:
            self._times.popleft()
        stamp = self._times[0].before(self._sample)
        t0_ns = max(later(stamp.t_ns, self._sample - stamp.sample, stamp.dt_s), self._earliest_ns)
        self._earliest_ns = later(t0_ns, n, WAITING * stamp.dt_s)
        block = RawSamples(self._sample, t0_ns, stamp.dt_s, a[:n], self._lost)
        self._sample += n
        self._lost = 0
        self._held = [a[n:]] if n < len(a) else []
        self._n_held -= n
        return block
