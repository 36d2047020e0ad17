"""Stepwise search for causes: forward, backward, and in pairs where two hide each other.

It knows neither what a likelihood is made of nor any effect by its name.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Generic, Protocol, TypeVar

import numpy as np

from fitter.diagnosis.evidence import ODDS_NATS, Fitted, is_better, worth
from fitter.diagnosis.hypothesis import Hypothesis

#: The best starts of a screening that are fitted: it keeps the weights as they are, so its order is a guess.
FITTED = 8
#: Of these so many are judged in any case, were they worse than the best where they were fitted.
JUDGED = 3
#: Of these the best are tried in pairs, where none is worth it alone.
PAIRED = 5

F = TypeVar("F", bound=Fitted)


class Start(Protocol):
    """A hypothesis at its best start."""

    @property
    def hypothesis(self) -> Hypothesis:
        """What it is."""

    @property
    def gain(self) -> float:
        """About how many nats it gains."""

    @property
    def n_start(self) -> int:
        """How many places were tried."""


class Likelihood(Protocol[F]):
    """A likelihood that causes are sought by."""

    def fit_base(self) -> F:
        """Return the model without any effect."""

    def screen(self, fit: F) -> Sequence[Start]:
        """Return all hypotheses that are not in a model, those first that gain most."""

    def fit_all(self, fit: F, some: Sequence[Sequence[Start]]) -> list[F]:
        """Return models with further hypotheses, fitted, those that are accepted kept as they are."""

    def judge(self, fits: Sequence[F]) -> list[F]:
        """Return models with the likelihood of all trials, those too that they were not fitted to."""

    def refit(self, fit: F) -> F:
        """Return a model with all its numbers sought anew."""

    def fit_without(self, fit: F, place: int) -> F:
        """Return a model without one of its hypotheses, fitted."""

    def is_possible(self, fit: F) -> bool:
        """Say whether a model's numbers are such that a machine can have them."""

    def is_exact(self, fit: F) -> bool:
        """Say whether a model leaves no more than the sensors' noise."""


@dataclass(frozen=True)
class Step(Generic[F]):
    """One accepted cause.

    Attributes
    ----------
    hypothesis : Hypothesis
    worth : float
        When it was accepted [nats].
    equals : tuple of F
        Models with another hypothesis in its place that fit equally well.
    """

    hypothesis: Hypothesis
    worth: float
    equals: tuple[F, ...] = ()


@dataclass(frozen=True)
class Found(Generic[F]):
    """What a search has found.

    Attributes
    ----------
    base, final : F
    steps : tuple of Step
        In the order of their acceptance.
    tried : tuple of (Hypothesis, F)
        Fitted beside the base alone, the best first.
    screened : tuple of Start
        All, beside the base alone.
    """

    base: F
    final: F
    steps: tuple[Step[F], ...] = ()
    tried: tuple[tuple[Hypothesis, F], ...] = ()
    screened: tuple[Start, ...] = field(default=())


class Stepwise(Generic[F]):
    """A search for causes by some likelihood.

    Parameters
    ----------
    likelihood : Likelihood
    families : int
        How many hypotheses there are.
    most : int
        Causes that are sought at the most.
    progress : callable, optional
        Told how many causes were found.
    """

    def __init__(
        self,
        likelihood: Likelihood[F],
        families: int,
        most: int = 9,
        progress: Callable[[int], None] | None = None,
    ) -> None:
        self._likelihood, self._families, self._most = likelihood, families, most
        self._progress = progress or (lambda _n: None)

    def run(self) -> Found[F]:
        """Return the causes of what the base model leaves."""
        base = fit = self._likelihood.fit_base()
        steps: list[Step[F]] = []
        tried: tuple[tuple[Hypothesis, F], ...] = ()
        screened: tuple[Start, ...] = ()
        while len(steps) < self._most and not self._likelihood.is_exact(fit):
            starts = list(self._likelihood.screen(fit))
            candidates = self._fitted(fit, [[one] for one in starts[:FITTED]])
            if not steps:
                screened = tuple(starts)
                tried = tuple((some[0].hypothesis, one) for some, one in candidates)
            new = self._best(fit, candidates)
            if new is None:
                pairs = [list(pair) for pair in combinations([some[0] for some, _ in candidates[:PAIRED]], 2)]
                new = self._best(fit, self._fitted(fit, pairs))
            if new is None:
                break
            fit, more = new
            fit, steps = self._pruned(self._likelihood.refit(fit) if steps else fit, [*steps, *more])
            self._progress(len(steps))
        return Found(base, fit, tuple(steps), tried, screened)

    def _fitted(self, fit: F, some: Sequence[Sequence[Start]]) -> list[tuple[Sequence[Start], F]]:
        """Return possible models with further hypotheses, judged, the best first.

        Models that are clearly worse than the best of them where they were fitted are not judged, but for a few.
        """
        fitted = list(zip(some, self._likelihood.fit_all(fit, some), strict=True))
        possible = [one for one in fitted if self._likelihood.is_possible(one[1])]
        ranked = sorted(possible, key=lambda one: -float(one[1].nats[one[1].learnt].sum()))
        kept = [one for k, one in enumerate(ranked) if k < JUDGED or not is_better(ranked[0][1], one[1], True)]
        judged = self._likelihood.judge([one for _, one in kept])
        both = [(starts, one) for (starts, _), one in zip(kept, judged, strict=True)]
        return sorted(both, key=lambda one: -self._worth(one[1], fit, one[0]))

    def _worth(self, one: F, other: F, starts: Sequence[Start]) -> float:
        places = int(np.prod([max(start.n_start, 1) for start in starts]))
        return worth(one, other, places, self._families ** len(starts))

    def _best(self, fit: F, candidates: Sequence[tuple[Sequence[Start], F]]) -> tuple[F, list[Step[F]]] | None:
        """Return the best model that is worth it and helps where nothing was fitted, with its steps."""
        kept = [
            (starts, one)
            for starts, one in candidates
            if self._worth(one, fit, starts) > ODDS_NATS and held_out_gain(one, fit) > 0.0
        ]
        if not kept:
            return None
        best = kept[0][1]
        level = [(starts, one) for starts, one in kept if not is_better(best, one)]
        fewest = min(one.n_number for _, one in level)
        equal = [(starts, one) for starts, one in level if one.n_number == fewest]
        (starts, chosen), others = equal[0], equal[1:]
        own = self._worth(chosen, fit, starts)
        if len(starts) == 1:
            return chosen, [Step(starts[0].hypothesis, own, tuple(one for _, one in others))]
        return chosen, [Step(start.hypothesis, own) for start in starts]

    def _pruned(self, fit: F, steps: list[Step[F]]) -> tuple[F, list[Step[F]]]:
        """Return a model without the causes that the last one has made needless."""
        for place in reversed(range(len(steps) - 1)):
            smaller = self._likelihood.fit_without(fit, place)
            if worth(fit, smaller, 1, self._families) < ODDS_NATS:
                fit, steps = smaller, [one for k, one in enumerate(steps) if k != place]
        return fit, steps


def held_out_gain(one: Fitted, other: Fitted) -> float:
    """Return what a model gains on trials that it was not fitted to [nats]."""
    gain = one.nats - other.nats
    return float(gain[~one.learnt].sum()) if np.any(~one.learnt) else float("inf")
