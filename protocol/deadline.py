"""A periodic beat on absolute deadlines."""

from collections.abc import Callable


class Ticker:
    """Waits for deadline after deadline, each at ``start + k * period``.

    A deadline is never "now plus a period", so lateness does not add up: over any time the rate is right.

    Parameters
    ----------
    period_s : float
        Time from one deadline to the next [s].
    clock : callable
        Returns the time [s], never going back, such as `time.monotonic`.
    sleep : callable
        Waits for a number of seconds, such as `time.sleep`; may return early.

    Attributes
    ----------
    k : int
        Number of the deadline waited for last; 0 is the start.
    worst_s : float
        The greatest lateness so far [s].
    skipped : int
        Deadlines given up by `skip_missed`.

    Raises
    ------
    ValueError
        If the period is not above 0.
    """

    def __init__(self, period_s: float, clock: Callable[[], float], sleep: Callable[[float], object]) -> None:
        if not period_s > 0.0:
            raise ValueError(f"period is {period_s} s, expected above 0")
        self.period_s = period_s
        self.k = 0
        self.worst_s = 0.0
        self.skipped = 0
        self._clock = clock
        self._sleep = sleep
        self._start = clock()

    def deadline_s(self, k: int) -> float:
        """Return deadline k on the clock [s]."""
        return self._start + k * self.period_s

    def wait(self) -> float:
        """Wait for the next deadline; where it has passed already, return at once.

        Returns
        -------
        float
            How late it is [s].
        """
        self.k += 1
        deadline = self.deadline_s(self.k)
        while (remaining := deadline - self._clock()) > 0.0:
            self._sleep(remaining)
        self.worst_s = max(self.worst_s, -remaining)
        return -remaining

    def skip_missed(self) -> int:
        """Give up the deadlines that have passed, and return how many; the beat stays where it was."""
        passed = int((self._clock() - self._start) / self.period_s)
        missed = max(0, passed - self.k)
        self.k += missed
        self.skipped += missed
        return missed
