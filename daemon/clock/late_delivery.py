"""Stamps that were moved because all arrivals came late, and how far off they are if only the delivery was late.

A clock that halts together with the sampling, and a line that holds bytes back, show the same: ticks go on, and
what arrives is late. Stamps follow arrivals, which come after what they bring. Had only the delivery been late,
they would still be on the line from before. So the distance from that line is an error of the stamps, until a
delivery that has caught up takes them back to it, or until no delivery is late for so long.
"""

from typing import NamedTuple

#: A delivery that was late is on time again after this, a convention: what a second's buffer holds is gone in 20 s
#: where the line is faster than the stream by a twentieth [s].
_HELD_S = 30.0


class _Line(NamedTuple):
    device_s: float
    host_s: float
    rate: float
    rate_std: float


class LateDelivery:
    """Keeps the line on which stamps were while arrivals were on time."""

    def __init__(self) -> None:
        self._on_time: _Line | None = None
        self._before: _Line | None = None
        self._until_s = 0.0

    def on_time(self, device_s: float, host_s: float, rate: float, rate_std: float) -> None:
        """Note a point of the line that arrivals agree with.

        Parameters
        ----------
        device_s, host_s : float
            The point [s].
        rate, rate_std : float
            Host's seconds in one of the device's, and its standard error.
        """
        self._on_time = _Line(device_s, host_s, rate, rate_std)

    def moved(self, device_s: float) -> None:
        """Note that stamps from ``device_s`` [s] on follow arrivals that were late."""
        if self._before is None or device_s >= self._until_s:
            self._before = self._on_time
        self._until_s = device_s + _HELD_S

    def error_s(self, device_s: float, stamped_s: float) -> float:
        """Return how far a stamp may be from the line before, 0 where it is not in doubt [s]."""
        if self._before is None or device_s >= self._until_s:
            self._before = None
            return 0.0
        since_s = device_s - self._before.device_s
        expected_s = self._before.host_s + self._before.rate * since_s
        return abs(stamped_s - expected_s) + self._before.rate_std * since_s
