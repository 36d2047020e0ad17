"""Whether frames are of the device that a run is about: one that has come back must first say what it is."""

from collections import deque
from typing import NamedTuple

from daemon.acquisition.handshake import same_device
from protocol.device_info import DeviceInfo
from protocol.serial_frame import SamplesFrame

#: Frames that wait for the INFO of a device that has come back: some seconds of them.
_WAITING = 8192


class Waiting(NamedTuple):
    """A frame that waits, and the host's monotonic clock when it came [ns]."""

    frame: SamplesFrame
    arrival_ns: int


class DeviceIdentity:
    """Holds back frames until it is known whose they are, and counts those of other devices.

    Parameters
    ----------
    info : DeviceInfo
        What the run's device says of itself.

    Attributes
    ----------
    known : bool
        Whether the device that is there has said that it is this one.
    strangers : int
        Frames that were not of this device, or not what its INFO says.
    stranger : str or None
        What the device is that is there instead, if there is one.
    """

    def __init__(self, info: DeviceInfo) -> None:
        self.known = True
        self.strangers = 0
        self.stranger: str | None = None
        self._info = info
        self._waiting: deque[Waiting] = deque(maxlen=_WAITING)

    def has(self, n_channel: int) -> bool:
        """Say whether frames with this number of channels are surely of this device."""
        return self.known and n_channel == len(self._info.channels)

    def holds_back(self, frame: SamplesFrame, arrival_ns: int) -> bool:
        """Say whether a frame is not to be used, now or ever; ``arrival_ns`` is when it came."""
        if self.stranger is not None:
            self.strangers += 1
        elif not self.known:
            self._waiting.append(Waiting(frame, arrival_ns))
        elif not self.has(frame.counts.shape[1]):
            self.strangers += 1
        else:
            return False
        return True

    def lost(self) -> None:
        """Note that the device is gone: what waited is nobody's."""
        self.strangers += len(self._waiting)
        self._waiting.clear()

    def came_back(self) -> None:
        """Note that a device is there again."""
        self.known, self.stranger = False, None

    def meet(self, info: DeviceInfo) -> list[Waiting]:
        """Take what the device that is there says of itself; return the frames that waited for it."""
        waiting = list(self._waiting)
        self._waiting.clear()
        self.known = same_device(info, self._info)
        self.stranger = None if self.known else f"{info.device} {info.serial}"
        if self.known:
            return waiting
        self.strangers += 1 + len(waiting)
        return []
