"""Runs of accelerations: counts of frames that follow each other, in physical units and with their times."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from arm.model import Floats
from daemon.clock.device_clock import Clock
from daemon.reception.channel_watch import ChannelWatch, Counts


class StepTimes(Protocol):
    """Tells the time from one sample to the next."""

    def dt_s(self, ticks: int) -> float:
        """Return it at a tick."""


class Stamp(NamedTuple):
    """A sample's number, its UTC [ns], and the time from it to the next."""

    sample: int
    t_ns: int
    dt_s: float


class FrameTimes(NamedTuple):
    """When frames that follow each other were taken, which is reckoned only where it is asked.

    ``sample0`` is the number of the first sample, ``frame_samples`` how many each frame has, ``ticks`` what the
    device's clock showed at the first of each.
    """

    sample0: int
    frame_samples: int
    ticks: Sequence[int]
    clock: Clock
    steps: StepTimes

    def before(self, sample: int) -> Stamp:
        """Return the stamp of the first sample of the frame in which a sample came."""
        k = min((sample - self.sample0) // self.frame_samples, len(self.ticks) - 1)
        ticks = self.ticks[k]
        return Stamp(self.sample0 + k * self.frame_samples, self.clock.utc_ns(ticks), self.steps.dt_s(ticks))


class Run(NamedTuple):
    """Samples without a hole between them.

    ``lost`` samples are missing before the first, whose number is ``sample0``. ``times`` are those of all of its
    frames; ``a`` is (n_sample, n_channel) [m/s^2].
    """

    lost: int
    sample0: int
    times: Sequence[FrameTimes]
    a: Floats


@dataclass
class CountRun:
    """What is to become a `Run`: ``counts`` are those of its frames, each (n_sample, n_channel)."""

    lost: int
    sample0: int
    times: list[FrameTimes]
    counts: list[Counts]

    def joined(self) -> Counts:
        """Return all counts, (n_sample, n_channel)."""
        return self.counts[0] if len(self.counts) == 1 else np.concatenate(self.counts)


class CountedRuns:
    """Gathers the counts of frames into runs, and has them watched and turned into accelerations.

    Parameters
    ----------
    watch : ChannelWatch
    """

    def __init__(self, watch: ChannelWatch) -> None:
        self._watch = watch
        self._counted: list[CountRun] = []

    def add(self, times: FrameTimes, counts: Counts, lost: int = 0) -> None:
        """Add frames that go on where the last ones ended, or after samples that were lost."""
        if lost or not self._counted:
            self._counted.append(CountRun(lost, times.sample0, [], []))
        self._counted[-1].times.append(times)
        self._counted[-1].counts.append(counts)

    def take(self) -> list[Run]:
        """Return the runs since the last time."""
        counted, self._counted = self._counted, []
        return [Run(one.lost, one.sample0, one.times, self._watch.watch(one.joined())) for one in counted]
