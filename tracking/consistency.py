"""Whether a filter's readings fit its own claims."""

from dataclasses import dataclass

#: So many instants at the least before it is said that the filter is wrong.
_JUDGED = 100
#: The filter is wrong if its misses are so many times as large as it claims, or if readings are doubted this
#: often.
_WRONG_SIZE, _WRONG_SHARE = 3.0, 0.01


@dataclass(frozen=True)
class Consistency:
    """How well the readings fit the filter's own claims, since somebody last asked.

    Attributes
    ----------
    size : float or None
        Mean squared innovation by the filter's claim: about 1 or less where it is right; None without readings.
    jolts : int
        Instants at which a joint's acceleration jumped.
    doubted : int
        Instants at which no motion of the arm explains the readings.
    wrong : bool
        Readings contradict the filter too often or by too much: the arm is not the one in its file, or a sensor
        fails.
    """

    size: float | None
    jolts: int
    doubted: int
    wrong: bool


class Judge:
    """Counts what `Consistency` says."""

    def __init__(self) -> None:
        self._clear()

    def _clear(self) -> None:
        self._instants, self._total, self._jolts, self._doubted = 0, 0.0, 0, 0

    def note(self, size: float, jolted: bool, doubted: bool) -> None:
        """Take in one instant: its mean squared innovation, and what became of it."""
        self._instants += 1
        self._total += size
        self._jolts += jolted
        self._doubted += doubted

    def take(self) -> Consistency:
        """Return the judgement and begin anew."""
        size = self._total / self._instants if self._instants else None
        wrong = self._instants >= _JUDGED and (
            self._total > _WRONG_SIZE * self._instants or self._doubted > _WRONG_SHARE * self._instants
        )
        said = Consistency(size, self._jolts, self._doubted, wrong)
        self._clear()
        return said
