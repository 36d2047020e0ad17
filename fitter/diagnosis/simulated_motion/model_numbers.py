"""The factors and psi of a fitted model as numbers of the arm that has its effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.simulated_motion.numbers import Numbers, numbers_of


@dataclass(frozen=True)
class ModelNumbers:
    """A fitted model whose factors and psi, one after the other, are moved together.

    Attributes
    ----------
    candidate : Candidate
    numbers : Numbers
        Of its arm.
    base : (n_base,) int
        Where the factors that are base parameters are among the arm's numbers.
    effects : sequence of sequence of (int, int)
        Of each hypothesis: which of its parameters is which of the arm's numbers.
    """

    candidate: Candidate
    numbers: Numbers
    base: NDArray[np.intp]
    effects: Sequence[Sequence[tuple[int, int]]]

    @property
    def start(self) -> Floats:
        """Factors and psi, base parameters as the arm has them: it is possible, and its friction brakes."""
        x = self.candidate.x.copy()
        x[: len(self.base)] = self.numbers.values[self.base]
        return np.concatenate([x, self.candidate.model.flat])

    @property
    def lasting(self) -> NDArray[np.bool_]:
        """Which of them are of what is always there: learning trials know nothing of what others have."""
        model = self.candidate.model
        stays = [one.comes_and_goes for one in model.hypotheses]
        columns = np.repeat(stays, [one.n_column for one in model.hypotheses])
        psi = np.repeat(stays, [len(own) for own in model.psi])
        return ~np.concatenate([np.zeros(len(self.base)), columns, psi]).astype(np.bool_)

    def at(self, flat: Floats) -> Candidate:
        """Return the model with other factors and psi."""
        n = len(self.candidate.x)
        return replace(self.candidate, model=self.candidate.model.at(flat[n:]), x=flat[:n])

    def values(self, flat: Floats) -> Floats:
        """Return the arm's numbers, (n_number,), for factors and psi."""
        moved, values = self.at(flat), self.numbers.values
        values[self.base] = moved.x[: len(self.base)]
        at = len(self.base)
        for one, psi, places in zip(moved.model.hypotheses, moved.model.psi, self.effects, strict=True):
            own = one.numbers(psi, moved.x[at : at + one.n_column])
            at += one.n_column
            for k, place in places:
                values[place] = own[k]
        return values

    def admitted(self, flat: Floats) -> Floats:
        """Return what must not be negative: how far effects' numbers and psi are within their limits."""
        values, (low, high) = self.values(flat), self.numbers.bounds
        model = self.candidate.model
        own = [place for places in self.effects for _, place in places]
        psi = flat[len(self.candidate.x) :]
        least, most = (
            np.concatenate([np.zeros(0), *(getattr(one, side) for one in model.hypotheses)])
            for side in ("low", "high")
        )
        return np.concatenate([(values - low)[own], (high - values)[own], psi - least, most - psi])


def model_numbers(
    arm: Arm, found: Estimates, candidate: Candidate, kept: Sequence[int], given: int
) -> ModelNumbers:
    """Return a fitted model's numbers in an arm that has its effects.

    Parameters
    ----------
    arm : Arm
        See `fitter.diagnosis.estimates.extended_arm`.
    found : Estimates
    candidate : Candidate
    kept : sequence of int
        Standard parameters that its factors stand for: base parameters but those that were denied or known.
    given : int
        How many effects the arm had before.
    """
    numbers = numbers_of(arm, found.base)
    effects, at = [], given
    for one in candidate.model.hypotheses:
        places = [(k, numbers.place(at, name)) for k, name in enumerate(one.names)]
        effects.append([(k, place) for k, place in places if place is not None and not one.comes_and_goes])
        at += max(1, sum(name.startswith("start_s_") for name in one.names))
    base = np.array([found.base.independent.index(int(column)) for column in kept], dtype=np.intp)
    return ModelNumbers(candidate, numbers, base, effects)
