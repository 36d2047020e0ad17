"""A model of what an arm does beyond its base parameters: hypotheses with values of their psi; fitted or not."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis, Turn

#: A psi of less than this is moved as if it were this large: a milliradian, a millisecond.
LEAST_PSI = 1e-3


@dataclass(frozen=True)
class Model:
    """Hypotheses with the values of their psi."""

    hypotheses: tuple[Hypothesis, ...] = ()
    psi: tuple[Floats, ...] = ()

    def plus(self, hypothesis: Hypothesis, psi: Floats) -> "Model":
        """Return this model with one hypothesis more."""
        return Model((*self.hypotheses, hypothesis), (*self.psi, np.asarray(psi, dtype=np.float64)))

    def without(self, k: int) -> "Model":
        """Return this model without its k-th hypothesis."""
        return self.only([i != k for i in range(len(self.hypotheses))])

    def only(self, some: Sequence[bool]) -> "Model":
        """Return this model with some of its hypotheses."""
        keep = [i for i, one in enumerate(some) if one]
        return Model(tuple(self.hypotheses[i] for i in keep), tuple(self.psi[i] for i in keep))

    def at(self, flat: Floats) -> "Model":
        """Return this model with other values of psi, one after the other."""
        sizes = np.cumsum([len(one) for one in self.psi])[:-1]
        return replace(self, psi=tuple(np.split(np.asarray(flat, dtype=np.float64), sizes)))

    @property
    def flat(self) -> Floats:
        """All psi, one after the other."""
        return np.concatenate([np.zeros(0), *self.psi])

    def beside(self) -> Iterator[tuple["Model", "Model", float]]:
        """Yield for every psi this model with more and with less of it, and how far these are apart."""
        for k, (hypothesis, psi) in enumerate(zip(self.hypotheses, self.psi, strict=True)):
            for i, value in enumerate(psi):
                step = hypothesis.stride * max(abs(float(value)), LEAST_PSI)
                ends = min(value + step, hypothesis.high[i]), max(value - step, hypothesis.low[i])
                one = np.arange(len(psi)) == i
                more, less = (self._with(k, np.where(one, end, psi)) for end in ends)
                yield more, less, float(ends[0] - ends[1])

    def _with(self, k: int, psi: Floats) -> "Model":
        return replace(self, psi=(*self.psi[:k], psi, *self.psi[k + 1 :]))

    @property
    def n_column(self) -> int:
        """How many columns its hypotheses add."""
        return sum(hypothesis.n_column for hypothesis in self.hypotheses)

    @property
    def is_event(self) -> bool:
        """Whether something in it happens at certain times or trials only."""
        return any(hypothesis.is_event for hypothesis in self.hypotheses)

    @property
    def cuts_off(self) -> bool:
        """Whether a drive has a limit."""
        return any(hypothesis.is_limit for hypothesis in self.hypotheses)

    @property
    def distorts(self) -> bool:
        """Whether a drive is late, weak or unequal."""
        return any(hypothesis.distorts for hypothesis in self.hypotheses)

    def undistorted(self) -> "Model":
        """Return this model without such drives."""
        return self.only([not hypothesis.distorts for hypothesis in self.hypotheses])

    @property
    def scales_only(self) -> bool:
        """Whether a gain in it does no more than scale what its joint resists with: nothing feels it."""
        return not any(hypothesis.feels_torque for hypothesis in self.hypotheses)

    def downstream(self) -> list[int]:
        """Return the places of its hypotheses in the order in which they act; of those with columns it stays."""
        gain = Turn.SCALE if self.scales_only else Turn.GAIN

        def turn(k: int) -> Turn:
            hypothesis = self.hypotheses[k]
            if hypothesis.is_gain:
                return gain
            return Turn.COLUMNS if hypothesis.n_column else hypothesis.turn

        return sorted(range(len(self.hypotheses)), key=turn)


@dataclass(frozen=True)
class Candidate:
    """A fitted model.

    Attributes
    ----------
    model : Model
        What was accepted before, and a hypothesis as its last.
    x : (n_factor,)
        Base parameters and the columns' factors.
    squares : (n_trial,)
        Sum of squares that is left in each trial, in units of the noise.
    """

    model: Model
    x: Floats
    squares: Floats

    @property
    def hypothesis(self) -> Hypothesis:
        """What was added last."""
        return self.model.hypotheses[-1]
