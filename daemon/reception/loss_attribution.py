"""Why samples are missing: what is known to have happened, or what the line has damaged of late."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from protocol.serial_frame import HEADER_BYTES, PAYLOAD_CRC_BYTES, SamplesFrame
from protocol.serial_parser import ParserCounters

#: Looks at good frames within which damage explains what is found missing: a frame waits for those before it.
_LOOKS = 16
#: Bytes of no frame explain as many frames as they would make, this fraction of each at the least; a convention.
_SHARE = 0.5


@dataclass
class _Damage:
    look: int
    frames: int
    bytes: int


class LossAttribution:
    """Keeps what happened, and the damage that explains nothing yet.

    A frame that fails its checksum is one that was sent. Where nothing is left to know a frame by, as at another
    baud rate, its bytes are; so a few bytes of garbage do not pass for frames that never came.

    Parameters
    ----------
    counters : ParserCounters
        Of the parser, read at each look.

    Attributes
    ----------
    why : str or None
        What has happened since the last samples that explains whatever is missing, if anything has.
    """

    def __init__(self, counters: ParserCounters) -> None:
        self.why: str | None = None
        self._counters = counters
        self._recent: deque[_Damage] = deque()
        self._look, self._good = 0, counters.frames
        self._seen = self._counted()

    def look(self) -> None:
        """Note what has been damaged since the last look."""
        frames, wasted = self._counted()
        if (frames, wasted) != self._seen:
            if not (self._recent and self._recent[-1].look == self._look):
                self._recent.append(_Damage(self._look, 0, 0))
            self._recent[-1].frames += frames - self._seen[0]
            self._recent[-1].bytes += wasted - self._seen[1]
            self._seen = frames, wasted
        self._look += self._counters.frames > self._good
        self._good = self._counters.frames
        while self._recent and self._recent[0].look < self._look - _LOOKS:
            self._recent.popleft()

    def forget(self) -> None:
        """Forget what was damaged until now."""
        self._recent.clear()
        self._seen = self._counted()

    def cause(self, lost: int, frame: SamplesFrame, follows: Callable[[SamplesFrame], bool]) -> str:
        """Return why samples are missing before a frame, which may follow the last one by its number."""
        if self.why is not None:
            return self.why
        if follows(frame):
            return "lost in the device"
        return "damaged on the line" if self.explains(lost, frame) else "frames missing"

    def explains(self, lost: int, frame: SamplesFrame) -> bool:
        """Say whether damage is why samples are missing before a frame; it then explains no others."""
        n_sample, n_channel = frame.counts.shape
        frames = -(-lost // n_sample)
        frame_bytes = frames * (HEADER_BYTES + 2 * n_sample * n_channel + PAYLOAD_CRC_BYTES)
        damaged = sum(damage.frames for damage in self._recent)
        if not damaged and sum(damage.bytes for damage in self._recent) < _SHARE * frame_bytes:
            return False
        for damage in self._recent:
            used, used_bytes = min(frames, damage.frames), min(frame_bytes, damage.bytes)
            damage.frames, damage.bytes = damage.frames - used, damage.bytes - used_bytes
            frames, frame_bytes = frames - used, frame_bytes - used_bytes
        return True

    def _counted(self) -> tuple[int, int]:
        return self._counters.crc_errors + self._counters.malformed, self._counters.discarded_bytes
