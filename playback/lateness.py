"""How late messages left, measured against their deadlines."""

import numpy as np

#: Messages that the percentiles look back on: 20 s at 1 kHz, and little enough to be looked through once a second.
WINDOW = 20_000


class Lateness:
    """Percentiles over the last messages, and the worst of all."""

    def __init__(self) -> None:
        self._late_s = np.zeros(WINDOW)
        self._n = 0
        self._max_s = 0.0

    def add(self, late_s: float) -> None:
        """Take note of one message that left this long after its deadline [s]."""
        self._late_s[self._n % WINDOW] = late_s
        self._n += 1
        self._max_s = max(self._max_s, late_s)

    def summary_ms(self) -> dict[str, float | None]:
        """Return p50, p99 and max [ms], None as long as nothing was sent."""
        if not self._n:
            return {"p50": None, "p99": None, "max": None}
        p50, p99 = np.percentile(self._late_s[: self._n], (50, 99))
        return {"p50": float(p50) * 1e3, "p99": float(p99) * 1e3, "max": self._max_s * 1e3}
