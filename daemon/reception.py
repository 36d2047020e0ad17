"""From bytes to accelerations: frames, their numbers accounted for, runs of samples without a hole."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from daemon.channel_watch import ChannelWatch, Counts
from daemon.device_clock import DeviceClock
from daemon.handshake import same_device
from daemon.ring import Chunk
from daemon.sample_ledger import SampleLedger
from limbcal.errors import DeviceError
from protocol.serial_frame import InfoFrame, SamplesFrame
from protocol.serial_parser import FrameParser


@dataclass(frozen=True)
class Run:
    """Samples without a hole between them.

    ``lost`` samples are missing before the first, whose number is ``sample0`` and whose time ``t0_ns``;
    ``a`` is (n_sample, n_channel) [m/s^2].
    """

    lost: int
    sample0: int
    t0_ns: int
    a: Floats


@dataclass
class _Group:
    """Frames that follow each other."""

    lost: int
    sample0: int
    frames: list[SamplesFrame]


class Reception:
    """Turns what arrived into runs of accelerations.

    Parameters
    ----------
    parser : FrameParser
    introduction : InfoFrame
        The INFO by which counts are understood.
    port : str
        For the sentences.
    """

    def __init__(self, parser: FrameParser, introduction: InfoFrame, port: str) -> None:
        self.info = introduction.info
        self.parser = parser
        self.ledger = SampleLedger(self.info.rate_hz, self.info.tick_hz)
        self.watch = ChannelWatch(self.info.channels, self.info.rate_hz)
        self._port = port
        self._clock: DeviceClock | None = None
        self._scale = np.array([channel.scale for channel in self.info.channels])
        self._offset = np.array([channel.offset for channel in self.info.channels])
        self.ledger.pass_over(introduction.sequence)

    def take(self, chunks: Sequence[Chunk]) -> list[Run]:
        """Take what arrived and return its samples.

        Raises
        ------
        DeviceError
            If the device was restarted, or its frames are not what its INFO said.
        """
        groups: list[_Group] = []
        for frame in self.parser.feed(b"".join(chunk.data for chunk in chunks)):
            self._check(frame)
            if isinstance(frame, InfoFrame):
                self.ledger.pass_over(frame.sequence)
                continue
            lost = self.ledger.enter(frame)
            if lost or not groups:
                groups.append(_Group(lost, self.ledger.position - len(frame.counts), []))
            groups[-1].frames.append(frame)
        if not groups:
            return []
        counts = [np.concatenate([frame.counts for frame in group.frames]) for group in groups]
        if self._clock is None:
            self._clock = self._started_clock(groups[0], sum(map(len, counts)), chunks[-1].stamp_ns)
        return [self._run(group, c, self._clock) for group, c in zip(groups, counts, strict=True)]

    def _run(self, group: _Group, counts: Counts, clock: DeviceClock) -> Run:
        self.watch.watch(counts)
        t0_ns = clock.utc_ns(group.frames[0].ticks)
        return Run(group.lost, group.sample0, t0_ns, counts * self._scale + self._offset)

    def _started_clock(self, first: _Group, n_sample: int, arrival_ns: int) -> DeviceClock:
        """Start the clock: the last of the first samples was taken, at the latest, when it arrived."""
        utc_of_arrival_ns = time.time_ns() - (time.monotonic_ns() - arrival_ns)
        first_utc_ns = utc_of_arrival_ns - round(n_sample * 1e9 / self.info.rate_hz)
        return DeviceClock(self.info.tick_hz, first.frames[0].ticks, first_utc_ns)

    def _check(self, frame: SamplesFrame | InfoFrame) -> None:
        if isinstance(frame, InfoFrame):
            if not same_device(frame.info, self.info):
                raise DeviceError(
                    f"port {self._port}: INFO frame {frame.sequence} differs from the first one, "
                    "expected the same rate and channels for as long as the device streams"
                )
        elif frame.counts.shape[1] != len(self._scale):
            raise DeviceError(
                f"port {self._port}: frame {frame.sequence} has {frame.counts.shape[1]} channels, "
                f"expected {len(self._scale)} as the device's INFO says"
            )
