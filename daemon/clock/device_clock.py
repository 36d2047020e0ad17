"""UTC of a device tick: the device's clock says how far it has come, the host's when that was.

`LeastLate` finds the device's rate against the host's monotonic clock, from when samples arrived. Most devices
have a crystal, whose rate is known beforehand better than arrivals of some seconds tell; one without is off by
what no crystal is. So a rate that a crystal may have is drawn to 1 as far as it is uncertain, and one that none
has is taken as it was found. UTC follows from the host's monotonic clock by what the host's two clocks differed by
when the stream began: a host clock that is set later does not tear the stamps.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from daemon.clock.late_delivery import LateDelivery
from daemon.clock.least_late import LeastLate, Line
from daemon.clock.stamp_line import StampLine

_SECOND_NS = 1_000_000_000
#: Of a crystal's rate: at most 100 ppm off over all temperatures, by data sheets; two standard deviations.
_CRYSTAL = 50e-6
#: Number of standard errors from a crystal's rate beyond which a clock has no crystal: by chance one in 370.
_SURELY = 3.0
#: An untrimmed oscillator without a crystal is at most this far off, by data sheets; what is further is no clock
#: that the host's can be held against, such as that of a device that plays a motion twice as fast.
_WORST = 0.15
#: A stamp may be later than its sample's arrival by this: what the least late arrivals differ by [s].
_EARLY_S = 0.001
#: Period over which both clocks are compared [s]; one that is off alike in two in a row is not followed any more.
_COMPARED_S, _IN_A_ROW = 0.25, 2
#: Within a period some arrival is late by less than this [s]: three times the latency of USB converters, 16 ms by
#: data sheets. And stamps are held back by less than this in all: a clock is faster by less than 4 % of a sudden.
_LATE_S, _HELD_S = 0.05, 0.01
#: While no error of the stamps is known it is this [ms]: what arrivals wait for at a reader that gathers bytes.
_UNKNOWN_MS = 10.0
#: An offset to the host's clock is said from this time on [s].
_SAID_S = 2.0


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
    rate : float
        Host's seconds in one of the device's, as far as is known.
    rate_std : float
        Of ``rate``.
    """

    ppm: float | None
    ppm_std: float | None
    error_ms: float | None
    rate: float = 1.0
    rate_std: float = _CRYSTAL


class Clock(Protocol):
    """Tells the time of a sample from the device's ticks."""

    @property
    def state(self) -> ClockState:
        """What is known of it."""

    def utc_ns(self, ticks: int) -> int:
        """Return UTC [ns] at a tick; never less than at an earlier one."""

    def monotonic_ns(self, ticks: int) -> int:
        """Return the host's monotonic clock [ns] at a tick."""

    def early_s(self, ticks: int, arrival_ns: int) -> float:
        """Return by how much something arrived before a tick was over, by the host's monotonic clock [s]."""

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
    rate : float
        Host's seconds in one of the device's, where that is known already.
    """

    def __init__(
        self, tick_hz: float, first_ticks: int, first_ns: int, utc_offset_ns: int, rate: float = 1.0
    ) -> None:
        self._tick_hz = tick_hz
        self._first_ticks = first_ticks
        self._first_ns = first_ns
        self._utc_offset_ns = utc_offset_ns
        self._stamps = StampLine(rate)
        self._arrivals = LeastLate(rate)
        self._followed = False
        self._compared = _Compared()
        self._moved = LateDelivery()
        #: Errors of the stamps: of the line through arrivals, and by how much all of these were late at last [s].
        self._line_s = self._late_s = 0.0
        self._state = ClockState(None, None, None, rate)

    @property
    def state(self) -> ClockState:
        """What is known of it."""
        return self._state

    def utc_ns(self, ticks: int) -> int:
        """Return UTC [ns] at a tick; never less than at an earlier one."""
        return self._utc_offset_ns + self._first_ns + round(_SECOND_NS * self._stamps.stamp(self._seconds(ticks)))

    def monotonic_ns(self, ticks: int) -> int:
        """Return the host's monotonic clock [ns] at a tick, as far as is known; stamps may yet come to differ."""
        return self._first_ns + round(_SECOND_NS * self._stamps.at(self._seconds(ticks)))

    def early_s(self, ticks: int, arrival_ns: int) -> float:
        """Return by how much something arrived before a tick was over, by the host's monotonic clock [s].

        Less is no more than what is not known of both.
        """
        error_ms = _UNKNOWN_MS if self._state.error_ms is None else self._state.error_ms
        unknown_s = _EARLY_S + 1e-3 * _SURELY * error_ms
        early_s = (self.monotonic_ns(ticks) - arrival_ns) / _SECOND_NS
        return max(early_s - unknown_s, 0.0) + min(early_s + unknown_s + _LATE_S, 0.0)

    def note(self, ticks: int, arrival_ns: int) -> None:
        """Note when a block had arrived whose end the device stamped so."""
        device_s, arrived_s = self._seconds(ticks), (arrival_ns - self._first_ns) / _SECOND_NS
        self._compare(device_s, arrived_s)
        if self._followed:
            self._stamps.hold_back(device_s, arrived_s + _EARLY_S)
        if self._arrivals.note(device_s, arrived_s) and (line := self._arrivals.line()) is not None:
            self._follow(line, device_s)

    def _compare(self, device_s: float, arrived_s: float) -> None:
        """Hold the stamps against arrivals; begin anew to follow where they have run away from these."""
        stamped_s = self._stamps.at(device_s)
        late_s = self._compared.note(stamped_s, arrived_s)
        if late_s is None:
            return
        self._late_s = max(late_s, 0.0)
        if late_s <= _LATE_S:
            self._moved.on_time(device_s, stamped_s, self._state.rate, self._state.rate_std)
        if self._compared.in_a_row >= _IN_A_ROW:
            self._compared = _Compared()
            self._arrivals = LeastLate(self._state.rate)
            if late_s > 0.0:
                self._moved.moved(device_s)
                self._stamps.catch_up(late_s)
        if self._state.error_ms is not None:
            self._state = replace(self._state, error_ms=self._error_ms(device_s))

    def _error_ms(self, device_s: float) -> float:
        moved_s = self._moved.error_s(device_s, self._stamps.at(device_s))
        return 1e3 * max(self._line_s, self._late_s, moved_s)

    def _follow(self, line: Line, device_s: float) -> None:
        self._followed = abs(line.rate - 1.0) <= _WORST
        if not self._followed:
            return
        rate, std, slope = _believed(line)
        off_s = self._stamps.approach(slope, line.host_s - slope * line.device_s)
        said = line.span_s >= _SAID_S
        stated = said or self._state.error_ms is not None  # a line that is begun anew leaves no error unsaid
        self._line_s = off_s + line.spread_s
        self._state = ClockState(
            1e6 * (1.0 / line.rate - 1.0) if said else None,
            1e6 * line.rate_std if said else None,
            self._error_ms(device_s) if stated else None,
            rate,
            std,
        )

    def _seconds(self, ticks: int) -> float:
        return (ticks - self._first_ticks) / self._tick_hz


class _Compared:
    """Compares stamps with arrivals over a while.

    Attributes
    ----------
    in_a_row : int
        How many times in a row they were too far apart. Where arrivals are less late than the last time a delivery
        catches up, and that is no such time.
    """

    def __init__(self) -> None:
        self.in_a_row = 0
        self._until_s: float | None = None
        self._late_s, self._held_s = np.inf, 0.0
        self._last_s = 0.0

    def note(self, stamped_s: float, arrived_s: float) -> float | None:
        """Note an arrival; at the end of a while return by how much all of them were late [s]."""
        if self._until_s is None:
            self._until_s = arrived_s + _COMPARED_S
        self._late_s = min(self._late_s, arrived_s - stamped_s)
        self._held_s += max(stamped_s - arrived_s - _EARLY_S, 0.0)
        if arrived_s < self._until_s:
            return None
        late_s, held_s = self._late_s, self._held_s
        self._until_s, self._late_s, self._held_s = arrived_s + _COMPARED_S, np.inf, 0.0
        too_late = late_s > max(_LATE_S, self._last_s - _LATE_S)
        self.in_a_row = self.in_a_row + 1 if too_late or held_s > _HELD_S else 0
        self._last_s = late_s
        return float(late_s)


def _believed(line: Line) -> tuple[float, float, float]:
    """Return a rate and its standard error, with what is known of crystals, and the slope of the stamps.

    Stamps go through arrivals as they came, whatever made all of them late: a slope that is off by some ppm would
    take the line, which goes through their middle, away from the latest of them.
    """
    off, std = line.rate - 1.0, line.rate_std
    if abs(off) > _SURELY * np.hypot(std, _CRYSTAL):
        return line.rate, std, line.rate
    share, as_came = (_CRYSTAL**2 / (_CRYSTAL**2 + one**2) for one in (std, line.scatter_std))
    return 1.0 + share * off, float(_CRYSTAL * std / np.hypot(_CRYSTAL, std)), float(1.0 + as_came * off)
