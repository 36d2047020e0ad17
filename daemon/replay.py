"""The replay process of `limbd run --replay`: a recording is a device again, on a real pty."""

import time
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from select import select

from daemon.control_line import ControlLine, SupervisorGone
from daemon.recorded_run import TICKS_PER_SAMPLE, Block, blocks_of, counts_of, device_of
from daemon.virtual_device import FRAME_SAMPLES, CommandLine, FrameFifo
from daemon.virtual_port import VirtualPort
from limbcal.errors import DataError
from protocol.deadline import Ticker
from protocol.serial_frame import encode_info, encode_samples

_BEAT_S = 0.005
#: No more is made while so much waits for its reader; the fifo holds that and the greatest block.
_AHEAD_BYTES, _FIFO_BYTES = 1 << 18, 1 << 24
#: After the last byte has left the tty still has some.
_LINGER_S = 0.5


def run_replay(line: ControlLine, path: str, speed: float) -> None:
    """Send a recording's samples as the device did, at its rate or so many times as fast.

    The supervisor hears ``ready`` with the port, and ``played`` when all has been read; it says ``stop``.

    Parameters
    ----------
    line : ControlLine
    path : str
        The recording; files that it was continued in follow.
    speed : float

    Raises
    ------
    DataError
        If the recording cannot be replayed.
    """
    with VirtualPort(None) as port:
        device = _ReplayedDevice(Path(path), speed)
        line.tell("ready", port=port.path)
        _serve(line, port, device)


class _ReplayedDevice:
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


def _serve(line: ControlLine, port: VirtualPort, device: _ReplayedDevice) -> None:
    def sleep(seconds: float) -> None:
        waited_for: list[VirtualPort | ControlLine] = [port, line]
        readable, writable, _ = select(waited_for, [port] if len(device.out) else [], [], seconds)
        if port in readable:
            device.receive(port.read(), time.monotonic())
        if port in readable or port in writable:
            device.out.drain(port.write)

    ticker, quiet_s = Ticker(_BEAT_S, time.monotonic, sleep), 0.0
    while not _told_to_stop(line):
        ticker.wait()
        ticker.skip_missed()
        device.advance(time.monotonic())
        device.out.drain(port.write)
        quiet_s = quiet_s + _BEAT_S if device.played and not len(device.out) else 0.0
        if _LINGER_S < quiet_s <= _LINGER_S + _BEAT_S:
            line.tell("played")


def _told_to_stop(line: ControlLine) -> bool:
    try:
        said = line.hear()
    except SupervisorGone:
        return True
    return said is not None and said["what"] == "stop"
