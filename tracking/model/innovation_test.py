"""Whether a filter's readings fit its own claims."""

from collections.abc import Sequence
from dataclasses import dataclass

#: Instants at the least before the filter is called wrong; the mean square of a right one's innovations is then
#: within 1 ± 0.42 (three standard deviations of chi2/100 with one degree of freedom an instant, the fewest).
_LEAST_INSTANTS = 100
#: The filter is wrong if its innovations' mean square is this many times what it claims, or if this fraction of
#: instants is doubted, where 1e-6 are by chance (`tracking.model.process_noise`); both conventions, far from
#: chance.
_WRONG_CHI2, _WRONG_FRACTION = 3.0, 0.01


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
    discrepancy_m_s2, base_m_s2 : float or None
        What the model lacks of a reading, and how its base accelerates along each axis, rms, at the most; None
        where readings fit the arm.
    """

    size: float | None
    jolts: int
    doubted: int
    wrong: bool
    discrepancy_m_s2: float | None = None
    base_m_s2: float | None = None


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

    def note_all(self, sizes: Sequence[float]) -> None:
        """Take in instants at which nothing became of their mean squared innovations."""
        self._instants += len(sizes)
        for size in sizes:  # one after the other, so that the sum is what `note` makes it
            self._total += size

    def take(self) -> Consistency:
        """Return the judgement and begin anew."""
        size = self._total / self._instants if self._instants else None
        wrong = self._instants >= _LEAST_INSTANTS and (
            self._total > _WRONG_CHI2 * self._instants or self._doubted > _WRONG_FRACTION * self._instants
        )
        said = Consistency(size, self._jolts, self._doubted, wrong)
        self._clear()
        return said
