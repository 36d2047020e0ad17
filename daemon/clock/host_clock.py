"""The host's two clocks beside each other: the one of the day may be set while samples come."""

import time
from collections.abc import Callable
from dataclasses import dataclass

#: A difference that changes by more is a clock that was set [ns]: on a busy machine both are read together within
#: less.
_JUMP_NS = 50_000_000
#: Readings of both, of which the quickest counts.
_READINGS = 3


@dataclass(frozen=True)
class Jump:
    """The host's clock was set: at ``t_ns`` by the clock of the run, forward by ``by_ns``."""

    t_ns: int
    by_ns: int


class HostClock:
    """Keeps the UTC of a run, and notices when the host's clock was set.

    The run goes on with what the two clocks differed by when it began: stamps of one run never jump.

    Parameters
    ----------
    utc_ns, monotonic_ns : callable
        The two clocks.

    Attributes
    ----------
    offset_ns : int
        UTC of the run less the monotonic clock.
    jumps : int
        How often the host's clock was set.
    """

    def __init__(
        self,
        utc_ns: Callable[[], int] = time.time_ns,
        monotonic_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._utc_ns, self._monotonic_ns = utc_ns, monotonic_ns
        self.offset_ns = self._latest = self._difference()
        self.jumps = 0

    @property
    def ahead_ns(self) -> int:
        """By how much the host's clock is ahead of the run's since it was set."""
        return self._latest - self.offset_ns

    def look(self) -> Jump | None:
        """Return the jump since the last look, if there was one."""
        now = self._difference()
        by, self._latest = now - self._latest, now
        if abs(by) < _JUMP_NS:
            return None
        self.jumps += 1
        return Jump(self._monotonic_ns() + self.offset_ns, by)

    def _difference(self) -> int:
        readings = []
        for _ in range(_READINGS):
            before = self._monotonic_ns()
            utc = self._utc_ns()
            after = self._monotonic_ns()
            readings.append((after - before, utc - (before + after) // 2))
        return min(readings)[1]
