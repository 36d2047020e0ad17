"""Frames that wait until enough came to tell whether samples are missing, or the rate is not what INFO says."""

from itertools import pairwise

from daemon.clock.tick_step import MAJORITY
from protocol.serial_frame import SEQUENCES, SamplesFrame

#: No more frames than these wait, however few of them follow each other.
_MOST = 4 * MAJORITY


class DoubtedFrames:
    """Holds frames back."""

    def __init__(self) -> None:
        self._frames: list[SamplesFrame] = []

    def __bool__(self) -> bool:
        return bool(self._frames)

    @property
    def enough(self) -> bool:
        """Whether as many of them follow each other as make a majority."""
        follow = sum(two.sequence == (one.sequence + 1) % SEQUENCES for one, two in pairwise(self._frames))
        return follow >= MAJORITY or len(self._frames) >= _MOST

    def put(self, frame: SamplesFrame) -> None:
        """Hold a frame back."""
        self._frames.append(frame)

    def take(self) -> list[SamplesFrame]:
        """Return all frames."""
        frames, self._frames = self._frames, []
        return frames
