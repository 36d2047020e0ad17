r"""UTC of a device tick: the device's clock says how far it has come, the host's when that was.

A block of samples cannot arrive before it was taken, and of all the delays on its way the shortest is much the
same at any time. So of each second the arrival that was least late counts, and a straight line through those,

    m = b + r (ticks / tick_hz),

with the host's monotonic clock m, gives the rate r and the offset b (least squares, and once more without those
that lie further from it than three times the median distance). UTC follows from m by what the host's two clocks
differed by when the stream began: a host clock that is set later does not tear the stamps. What has been stamped
stays, so a better line is approached by a rate that is a little off for some seconds, never by a jump.
"""

from collections import deque
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from arm.model import Floats

_SECOND_NS = 1_000_000_000
#: The line is drawn through the least late arrivals of so many seconds.
_SECONDS = 600
#: Before so many of them the rate is taken to be what the device says.
_FEW = 10
#: A better line is approached within this time, by a rate that differs by no more than this.
_APPROACH_S, _MOST_OFF = 10.0, 5e-4
#: A clock that runs more wrong than this is no clock.
_WORST_RATE = 2e-2
_OUTLIER = 3.0


@dataclass(frozen=True)
class ClockState:
    """What is known of a device's clock.

    Attributes
    ----------
    ppm : float or None
        By how much it is fast; None while too little has come.
    ppm_std : float or None
    error_ms : float or None
        Standard error of a stamp; what the shortest way takes is in none.
    """

    ppm: float | None
    ppm_std: float | None
    error_ms: float | None


class Clock(Protocol):
    """Tells the time of a sample from the device's ticks."""

    @property
    def state(self) -> ClockState:
        """What is known of it."""

    def utc_ns(self, ticks: int) -> int:
        """Return UTC [ns] at a tick; never less than at an earlier one."""

    def monotonic_ns(self, ticks: int) -> int:
        """Return the host's monotonic clock [ns] at a tick."""

    def note(self, ticks: int, arrival_ns: int) -> None:
        """Note when a block had arrived whose end the device stamped so."""


class DeviceClock:
    """The clock of a device that runs by itself, held against the host's.

    Parameters
    ----------
    tick_hz : float
    first_ticks : int
        Device clock at the first sample.
    first_ns : int
        Host's monotonic clock then [ns], as far as is known.
    utc_offset_ns : int
        UTC less the monotonic clock, for the whole stream.
    """

    def __init__(self, tick_hz: float, first_ticks: int, first_ns: int, utc_offset_ns: int) -> None:
        self._tick_hz = tick_hz
        self._first_ticks = first_ticks
        self._first_ns = first_ns
        self._utc_offset_ns = utc_offset_ns
        self._least_late: deque[tuple[float, float]] = deque(maxlen=_SECONDS)
        self._second: tuple[float, float] | None = None
        self._until_s = 0.0
        #: The line in use: device's and host's seconds since the first sample where it begins, and its rate.
        self._from_s, self._from_host_s, self._rate = 0.0, 0.0, 1.0
        self._state = ClockState(None, None, None)

    @property
    def state(self) -> ClockState:
        """What is known of it."""
        return self._state

    def utc_ns(self, ticks: int) -> int:
        """Return UTC [ns] at a tick; never less than at an earlier one."""
        return self._utc_offset_ns + self.monotonic_ns(ticks)

    def monotonic_ns(self, ticks: int) -> int:
        """Return the host's monotonic clock [ns] at a tick."""
        return self._first_ns + round(_SECOND_NS * self._host_s(self._seconds(ticks)))

    def note(self, ticks: int, arrival_ns: int) -> None:
        """Note when a block had arrived whose end the device stamped so."""
        device_s = self._seconds(ticks)
        arrived_s = (arrival_ns - self._first_ns) / _SECOND_NS
        if self._second is None or arrived_s - device_s < self._second[1] - self._second[0]:
            self._second = device_s, arrived_s
        if device_s >= self._until_s:
            self._least_late.append(self._second)
            self._second, self._until_s = None, device_s + 1.0
            self._draw(device_s)

    def _draw(self, now_s: float) -> None:
        """Draw the line anew."""
        if len(self._least_late) < _FEW:
            return
        device, arrived = np.array(self._least_late).T
        rate, offset, distance = _line(device, arrived)
        if abs(rate - 1.0) > _WORST_RATE:
            return
        spread = float(np.sqrt(np.sum(distance**2) / max(len(distance) - 2, 1)))
        off_s = abs(offset + rate * now_s - self._host_s(now_s))
        lever_s = float(np.std(device) * np.sqrt(len(device)))
        self._state = ClockState(1e6 * (1.0 / rate - 1.0), 1e6 * spread / lever_s, 1e3 * (off_s + spread))
        self._approach(now_s, rate, offset)

    def _approach(self, now_s: float, rate: float, offset: float) -> None:
        """Go on from where the stamps are, towards a better line."""
        here_s = self._host_s(now_s)
        missing_s = offset + rate * now_s - here_s
        self._from_s, self._from_host_s = now_s, here_s
        self._rate = rate + float(np.clip(missing_s / _APPROACH_S, -_MOST_OFF, _MOST_OFF))

    def _host_s(self, device_s: float) -> float:
        return self._from_host_s + self._rate * (device_s - self._from_s)

    def _seconds(self, ticks: int) -> float:
        return (ticks - self._first_ticks) / self._tick_hz


def _line(x: Floats, y: Floats) -> tuple[float, float, Floats]:
    """Return slope, offset and distances of a straight line through all but outliers."""
    slope, offset = np.polyfit(x, y - x, 1)
    distance = y - x - slope * x - offset
    near = np.abs(distance) <= _OUTLIER * 1.4826 * np.median(np.abs(distance)) + 1e-12
    if 2 < np.count_nonzero(near) < len(x):
        slope, offset = np.polyfit(x[near], (y - x)[near], 1)
        distance = (y - x - slope * x - offset)[near]
    return 1.0 + float(slope), float(offset), distance
