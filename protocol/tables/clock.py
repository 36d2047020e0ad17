"""Time stamps of every kind as seconds, without losing a digit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Stamps since 1970 lie between 1990 and 2100 [s]: in any unit they can be taken for no other.
_EPOCH = (631_152_000, 4_102_444_800)
#: Units a second that stamps are counted in.
_PER_SECOND = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}
#: Joint motion and accelerations come at such rates [Hz]: from a slow arm's to the fastest accelerometers'.
_RATES_HZ = (5.0, 40_000.0)
#: Stamps that float64 would hold more coarsely than this [s] are counted from the first one.
_FINEST_S = 1e-9


@dataclass
class Clock:
    """Turns the stamps of one file into seconds, block by block.

    Parameters
    ----------
    factor : float or None
        Length of the stamps' unit [s]; None where nobody said it: seconds, unless they can only be in another.

    Attributes
    ----------
    unit : str
        The unit that stamps turn out to be in: those since 1970, and whole numbers too far apart for seconds.
    since_1970 : bool
        Whether they count from then.
    origin : int
        What was taken off, in the stamps' own unit.
    """

    factor: float | None = None
    unit: str = ""
    since_1970: bool = False
    origin: int = 0
    _begun: bool = False

    @property
    def origin_s(self) -> float:
        """What was taken off [s]."""
        return self.origin * self._length

    @property
    def _length(self) -> float:
        return 1.0 if self.factor is None else self.factor

    def seconds(self, stamps: NDArray[np.generic]) -> Floats:
        """Return stamps [s]; those that float64 cannot hold to a nanosecond are counted from the file's first."""
        if not len(stamps):
            return np.empty(0)
        if not self._begun:
            self._begin(stamps)
        if stamps.dtype.kind in "iu" and self.origin:
            # Modulo 2^64 a difference is exact, of stamps with and without a sign.
            counted = stamps.astype(np.uint64) - np.uint64(self.origin % 2**64)
            return counted.astype(np.int64).astype(np.float64) * self._length
        return (stamps.astype(np.float64) - float(self.origin)) * self._length

    def _begin(self, stamps: NDArray[np.generic]) -> None:
        self._begun = True
        first = stamps[0]
        value = float(first)
        if not np.isfinite(value):
            return
        if self.factor is None:
            for unit, per_second in _PER_SECOND.items():
                if _EPOCH[0] * per_second <= value < _EPOCH[1] * per_second and unit != "s":
                    self.unit, self.factor, self.since_1970 = unit, 1.0 / per_second, True
        if self.factor is None and first.dtype.kind in "iu" and len(stamps) > 1:
            step = float(np.median(np.diff(stamps.astype(np.int64))))
            units = likely_units(step) if step > 1.0 else []
            if len(units) == 1:
                self.unit, self.factor = units[0], 1.0 / _PER_SECOND[units[0]]
        whole = first.dtype.kind in "iu" or self.unit
        if whole and np.spacing(abs(value) * self._length) > _FINEST_S:
            self.origin = int(first)


def likely_units(step: float) -> list[str]:
    """Return the units, other than seconds, in which stamps so far apart would come at a usual rate."""
    per_second = {unit: count for unit, count in _PER_SECOND.items() if unit != "s"}
    return [unit for unit, count in per_second.items() if _RATES_HZ[0] <= count / step <= _RATES_HZ[1]]
