"""Which of the devices that speak holds the arm."""

from dataclasses import dataclass

#: Time without an input after which a device holds nothing any more [s].
STALE_S = 0.020


@dataclass
class _Device:
    began_s: float
    heard_s: float


class Holders:
    """The devices that were heard of lately; the one whose touch began last holds the arm."""

    def __init__(self) -> None:
        self._devices: dict[bytes, _Device] = {}

    def hear(self, address: bytes, now_s: float) -> None:
        """Take note of an input; after a silence it begins a touch."""
        device = self._devices.get(address)
        if device is None or now_s - device.heard_s >= STALE_S:
            self._devices.pop(address, None)  # so that of two that begin in one tick it is the later one
            self._devices[address] = _Device(now_s, now_s)
        else:
            device.heard_s = now_s

    def holder(self, now_s: float) -> bytes | None:
        """Return whose arm it is, None where nobody was heard for 20 ms; those are forgotten."""
        for address in [a for a, device in self._devices.items() if now_s - device.heard_s >= STALE_S]:
            del self._devices[address]
        return max(
            self._devices, key=lambda a: (self._devices[a].began_s, list(self._devices).index(a)), default=None
        )

    def __len__(self) -> int:
        return len(self._devices)
