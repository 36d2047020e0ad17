"""A model of what an arm does beyond its base parameters: some hypotheses, with values of their psi."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis

#: A psi of less than this is moved as if it were this large.
_LEAST = 1e-3


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
                step = hypothesis.stride * max(abs(float(value)), _LEAST)
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
