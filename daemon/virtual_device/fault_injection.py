"""Makes the faults of a schedule happen to a virtual device."""

from collections.abc import Sequence
from dataclasses import replace

from daemon.virtual_device.fault_schedule import Fault, acting
from daemon.virtual_device.faulty_line import FaultyLine
from daemon.virtual_device.virtual_device import VirtualDevice
from daemon.virtual_device.virtual_port import VirtualPort
from protocol.device_info import DeviceInfo

#: How long it takes to pull one device and plug in another [s].
_SWAP_S = 0.3


class FaultInjection:
    """Brings the faults that act, and ends those that are over.

    Parameters
    ----------
    faults : sequence of Fault
    info : DeviceInfo
        What the device says of itself while it is no stranger.
    device : VirtualDevice
    line : FaultyLine
    port : VirtualPort
    """

    def __init__(
        self,
        faults: Sequence[Fault],
        info: DeviceInfo,
        device: VirtualDevice,
        line: FaultyLine,
        port: VirtualPort,
    ) -> None:
        self._faults, self._info, self._device, self._line, self._port = faults, info, device, line, port
        self._began_s: float | None = None
        self._now_s: float | None = None
        self._swapped_s: float | None = None

    def make(self, now_s: float) -> None:
        """Do what is due."""
        if self._began_s is None:
            self._began_s = self._device.started_s
        if self._began_s is None or not self._faults:
            return
        before, now = self._line.acting, acting(self._faults, now_s - self._began_s)
        began, ended = now.keys() - before.keys(), before.keys() - now.keys()
        self._line.acting = now
        if "restart" in ended:
            self._device.restart(now_s)
        if "restart" in began:
            self._line.cut()
        if "stranger" in began | ended:
            other = replace(self._info, serial="a stranger") if "stranger" in began else self._info
            self._device.become(other)
            self._swapped_s = now_s
        swapping = self._swapped_s is not None and now_s < self._swapped_s + _SWAP_S
        if "unplug" in now or swapping:
            if self._port.plugged:
                self._port.unplug()
                self._line.cut()
        elif not self._port.plugged:
            self._port.plug()
        self._line.rustle(0.0 if self._now_s is None else now_s - self._now_s)
        self._now_s = now_s
