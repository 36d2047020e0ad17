"""Getting to know the device: its INFO, and whether it is the one that the arm's sensors are wired to."""

import time
from collections.abc import Sequence
from dataclasses import replace

from arm.model import Arm
from daemon.acquisition.ring import Chunk, Mark
from limbcal.errors import DeviceError
from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import InfoFrame
from protocol.serial_parser import FrameParser

#: How long INFO is waited for [s]: a board that resets when its port is opened needs about two to start.
INFO_LIMIT_S = 5.0
#: Channels that a sentence names; those of eight sensors.
_NAMED = 24


class Handshake:
    """Waits for the device's INFO, and knows what came instead.

    Parameters
    ----------
    parser : FrameParser
    port : str
        For the sentences.
    limit_s : float
        How long to wait.
    """

    def __init__(self, parser: FrameParser, port: str, limit_s: float = INFO_LIMIT_S) -> None:
        self._parser = parser
        self._port = port
        self._limit_s = limit_s
        self._end = time.monotonic() + limit_s
        self._bytes = 0

    def hear(self, chunks: Sequence[Chunk]) -> InfoFrame | None:
        """Take what arrived; return the INFO once it is there.

        A device that streams already may have sent samples after it: the INFO then bears the number and the clock
        of the last of them, for the stream is what the device sends from here on.

        Raises
        ------
        DeviceError
            If the time is over.
        """
        introduction: InfoFrame | None = None
        for chunk in chunks:
            if chunk.mark in (Mark.OPENED, Mark.LOST):
                self._parser.reset()
            self._bytes += len(chunk.data)
            for frame in self._parser.feed(chunk.data):
                if isinstance(frame, InfoFrame):
                    introduction = frame
                elif introduction is not None:
                    introduction = replace(introduction, sequence=frame.sequence, ticks=frame.ticks)
        if introduction is not None:
            return introduction
        if time.monotonic() > self._end:
            raise DeviceError(
                f"port {self._port}: {self._seen()} within {self._limit_s:g} s, expected the device's INFO frame"
            )
        return None

    def _seen(self) -> str:
        counters = self._parser.counters
        if self._bytes == 0:
            return "the device sent nothing"
        found = f"no valid frame in {self._bytes} bytes"
        if counters.frames:
            found = f"{counters.frames} frames of samples and no INFO frame"
        return found if self._parser.last_error is None else f"{found} ({self._parser.last_error})"


def check_channels(info: DeviceInfo, arm: Arm, port: str) -> None:
    """Check that the device's channels are the arm's, see `arm.model.Arm.channels`, in their order.

    Raises
    ------
    DeviceError
        If they are not: another device may come, and a config that was right still is.
    """
    expected = list(arm.channels)
    found = [channel.name for channel in info.channels]
    if found != expected:
        raise DeviceError(
            f"port {port}: the device's channels are {_listed(found)}, "
            f"expected the sensors of arm {arm.name!r}: {_listed(expected)}"
        )


def _listed(names: Sequence[str]) -> str:
    if len(names) <= _NAMED:
        return " ".join(names)
    return f"{' '.join(names[:_NAMED])} and {len(names) - _NAMED} more"


def same_device(first: DeviceInfo, second: DeviceInfo) -> bool:
    """Tell whether two INFOs are of one device, and describe samples in the same way."""

    def essence(info: DeviceInfo) -> tuple[str, str, float, float, tuple[Channel, ...]]:
        return info.device, info.serial, info.rate_hz, info.tick_hz, info.channels

    return essence(first) == essence(second)
