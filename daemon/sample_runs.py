"""Runs of accelerations: counts of frames that follow each other, in physical units and stamped."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from daemon.channel_watch import Counts
from limbcal.compiled import compiled
from protocol.serial_frame import Channel


@dataclass(frozen=True)
class Run:
    """Samples without a hole between them.

    ``lost`` samples are missing before the first, whose number is ``sample0``. ``stamps`` are number and UTC [ns]
    of the first sample of each frame; ``a`` is (n_sample, n_channel) [m/s^2].
    """

    lost: int
    sample0: int
    stamps: tuple[tuple[int, int], ...]
    a: Floats


@dataclass
class CountRun:
    """What is to become a `Run`: ``counts`` are those of its frames, each (n_sample, n_channel)."""

    lost: int
    sample0: int
    stamps: list[tuple[int, int]]
    counts: list[Counts]

    def joined(self) -> Counts:
        """Return all counts, (n_sample, n_channel)."""
        return self.counts[0] if len(self.counts) == 1 else np.concatenate(self.counts)


class Conversion:
    """Turns counts into accelerations.

    Parameters
    ----------
    channels : sequence of Channel
    """

    def __init__(self, channels: Sequence[Channel]) -> None:
        self._scale = np.array([channel.scale for channel in channels])
        self._offset = np.array([channel.offset for channel in channels])

    def run(self, counted: CountRun, counts: Counts) -> Run:
        """Return the run of what was counted."""
        a = np.empty(counts.shape)
        _accelerations(counts, self._scale, self._offset, a)
        return Run(counted.lost, counted.sample0, tuple(counted.stamps), a)


@compiled
def _accelerations(counts: Counts, scale: Floats, offset: Floats, a: Floats) -> None:
    for k in range(counts.shape[0]):
        for c in range(counts.shape[1]):
            a[k, c] = scale[c] * counts[k, c] + offset[c]
