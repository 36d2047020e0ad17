"""A recording as a device: its samples when they are due, in frames as a device sends them."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from daemon.recording.recorded_run import TICKS_PER_SAMPLE, Block, blocks_of, counts_of, device_of
from daemon.virtual_device.virtual_device import FRAME_SAMPLES, CommandLine, FrameFifo
from limbcal.errors import DataError
from protocol.serial_frame import encode_info, encode_samples

#: Bytes waiting for their reader above which no more are made; the fifo holds these and the greatest block.
_AHEAD_BYTES, _FIFO_BYTES = 1 << 18, 1 << 24


class ReplayedDevice:
    """Answers INFO and START, and makes the frames of the samples that are due.

    Parameters
    ----------
    path : Path
        The recording; files that it was continued in follow.
    speed : float
        Times as fast as it was.

    Attributes
    ----------
    out : FrameFifo
        What waits for the reader.
    played : bool
        Whether all has been made.

    Raises
    ------
    DataError
        If there are no samples in it, or nothing says of which device.
    """

    def __init__(self, path: Path, speed: float) -> None:
        self._info = device_of(path)
        blocks = blocks_of(path)
        first = next(blocks, None)
        if first is None:
            raise DataError(f"recording {path}: there is no limb/raw in it, expected samples to replay")
        self._blocks: Iterator[Block] = chain([first], blocks)
        self._next: Block | None = None
        self._first = first.sample0
        self._rate_hz = speed * self._info.rate_hz
        self._started_s: float | None = None
        self._sequence = 0
        self._commands = CommandLine()
        self.out = FrameFifo(_FIFO_BYTES)
        self.played = False

    def receive(self, data: bytes, now_s: float) -> None:
        """Take what the reader sent."""
        for command in self._commands.take(data):
            if command in (b"INFO", b"START"):
                self.out.put(encode_info(self._info, self._number(), 0))
            if command == b"START" and self._started_s is None:
                self._started_s, self._next = now_s, next(self._blocks)
            elif command == b"STOP":
                self._next = None

    def advance(self, now_s: float) -> None:
        """Make the frames of the blocks that are due by now."""
        if self._started_s is None:
            return
        due = self._first + (now_s - self._started_s) * self._rate_hz
        while self._next is not None and len(self.out) < _AHEAD_BYTES:
            block = self._next
            if block.sample0 + len(block.a) > due:
                return
            counts = counts_of(block, self._info)
            for k in range(0, len(counts), FRAME_SAMPLES):
                ticks = TICKS_PER_SAMPLE * (block.sample0 + k)
                self.out.put(encode_samples(counts[k : k + FRAME_SAMPLES], self._number(), ticks))
            self._next = next(self._blocks, None)
        self.played = self._next is None

    def _number(self) -> int:
        self._sequence += 1
        return self._sequence
