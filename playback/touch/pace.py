"""Absolute deadlines, how well they are kept, and how long things take."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

#: How long before a deadline sleeping ends and looking at the clock begins [s].
SPIN_S = 40e-6
#: Width of a bin [us] and number of bins in which times are counted: to 20 ms, at which a hand is stale.
_BIN_US = 1.0
_BINS = 20_000


class Spread:
    """Percentiles of times, to a microsecond, at a fixed price a time; and the longest of all."""

    def __init__(self) -> None:
        self._counts: NDArray[np.int64] = np.zeros(_BINS, dtype=np.int64)
        self._max_s = 0.0

    def add(self, seconds: float) -> None:
        """Take note of a time; one of 20 ms and more only differs from others by the maximum."""
        self._counts[min(int(seconds * (1e6 / _BIN_US)), _BINS - 1)] += 1
        self._max_s = max(self._max_s, seconds)

    def summary(self, unit_s: float) -> dict[str, float | None]:
        """Return p50, p99 and max in a unit, None as long as there is nothing."""
        upto = np.cumsum(self._counts)
        if not upto[-1]:
            return {"p50": None, "p99": None, "max": None}
        p50, p99 = (
            (float(np.searchsorted(upto, share * upto[-1])) + 0.5) * _BIN_US * 1e-6 for share in (0.50, 0.99)
        )
        return {
            "p50": min(p50, self._max_s) / unit_s,
            "p99": min(p99, self._max_s) / unit_s,
            "max": self._max_s / unit_s,
        }


class Pace:
    """Waits for the ticks of a rate: tick k is due k periods after the start, however late the others were.

    Parameters
    ----------
    period_s : float
    monotonic : callable
    sleep : callable

    Attributes
    ----------
    ticks, overruns : int
        Ticks that were kept, and those that were missed because the one before took too long or came too late.
    lateness : Spread
        How long after its deadline each tick began.
    """

    def __init__(
        self,
        period_s: float,
        monotonic: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.period_s = period_s
        self.ticks = self.overruns = 0
        self.lateness = Spread()
        self._monotonic, self._sleep = monotonic, sleep
        self.start()

    def start(self) -> None:
        """Begin anew: the first tick is due in one period."""
        self._k = 0
        self.ticks = self.overruns = 0
        self.lateness = Spread()
        self.start_s = self.now_s = self._monotonic()

    def wait(self) -> int:
        """Wait for the next tick and return how many periods have passed since the last one."""
        due_s = self.start_s + (self._k + 1) * self.period_s
        left_s = due_s - self._monotonic() - SPIN_S
        if left_s > 0.0:
            self._sleep(left_s)
        while (now_s := self._monotonic()) < due_s:
            pass
        self.lateness.add(now_s - due_s)
        passed = 1 + int((now_s - due_s) / self.period_s)
        self._k += passed
        self.now_s = now_s
        self.ticks += 1
        self.overruns += passed - 1
        return passed

    @property
    def held_rate_hz(self) -> float:
        """Ticks a second since the start."""
        elapsed_s = self.now_s - self.start_s
        return self.ticks / elapsed_s if elapsed_s > 0.0 else 0.0
