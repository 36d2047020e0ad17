"""Causes sought one by one: forward, in pairs where two hide each other, and backward after every step.

The search knows neither what a likelihood is made of nor any effect by its name.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Protocol

import numpy as np

from fitter.diagnosis.evidence import Fit, is_better, log_evidence, penalised_log_likelihood
from fitter.diagnosis.least_squares import CLEAR_RATIO, N_REFINED, ODDS_NATS
from fitter.diagnosis.model import Hypothesis


class Likelihood(Protocol):
    """A likelihood that causes are sought by."""

    def base(self) -> Fit:
        """Return the model without any effect, under weights of its own."""

    def options(self, fit: Fit) -> Sequence[Fit]:
        """Return a model with one hypothesis more, for all of them that are possible, the likeliest first."""

    def joined(self, fit: Fit, options: Sequence[Fit]) -> Fit | None:
        """Return a model with the last hypothesis of each of some options; None if its numbers are impossible."""

    def without(self, fit: Fit, place: int) -> Fit:
        """Return a model without one of its hypotheses, fitted."""

    def instead(self, fit: Fit, place: int, other: Fit) -> Fit | None:
        """Return a model without one of its hypotheses and with another model's last one; None if impossible."""

    def everywhere(self, fit: Fit) -> Fit:
        """Return a model fitted to all trials, as if all might be learnt from."""

    def reweighted(self, fit: Fit) -> Fit:
        """Return a model under weights of its own, all its numbers sought anew."""

    def log_places(self, hypothesis: Hypothesis) -> float:
        """Return the logarithm of the number of places at which a hypothesis is sought."""

    def is_significant(self, fit: Fit) -> bool:
        """Say whether the sizes of all hypotheses of a model differ from none, under weights of its own."""

    def is_exact(self, fit: Fit) -> bool:
        """Say whether a model leaves no more than the sensors' noise."""

    def has_large_residual(self, fit: Fit) -> bool:
        """Say whether a model leaves so much that two hypotheses may hide each other in it."""


@dataclass(frozen=True)
class Step:
    """One accepted cause.

    Attributes
    ----------
    hypothesis : Hypothesis
    fit, before : Fit
        With and without it, when it was accepted.
    log_evidence : float
        Then [nats].
    equals : tuple of Fit
        Models with another hypothesis in its place that are as likely…
    beside : tuple of Fit
        … and each of these beside all causes that were found.
    options : tuple of Fit
        All that were tried in its stead, the likeliest first.
    """

    hypothesis: Hypothesis
    fit: Fit
    before: Fit
    log_evidence: float
    equals: tuple[Fit, ...] = ()
    options: tuple[Fit, ...] = ()
    beside: tuple[Fit, ...] = ()


@dataclass(frozen=True)
class Found:
    """What a search has found.

    Attributes
    ----------
    final : Fit
    steps : tuple of Step
        In the order of the model's hypotheses.
    first : tuple of Fit
        Every hypothesis added to the base alone, the likeliest first.
    base : Fit
        Beside which these were tried.
    """

    base: Fit
    final: Fit
    steps: tuple[Step, ...]
    first: tuple[Fit, ...]


class Stepwise:
    """A search for causes by some likelihood.

    Parameters
    ----------
    likelihood : Likelihood
    families : int
        How many hypotheses there are.
    most : int
        Causes that are sought at the most.
    progress : callable, optional
        Called with how many causes were found.
    """

    def __init__(
        self, likelihood: Likelihood, families: int, most: int, progress: Callable[[int], None] | None = None
    ) -> None:
        self._likelihood, self._families, self._most = likelihood, families, most
        self._progress = progress or (lambda _n: None)

    def run(self) -> Found:
        """Return the causes of the base model's residual."""
        base = fit = self._likelihood.base()
        steps: list[Step] = []
        first: tuple[Fit, ...] = ()
        known: set[frozenset[tuple[str, tuple[int, ...]]]] = set()
        while len(steps) < self._most and not self._likelihood.is_exact(fit):
            options = tuple(self._likelihood.options(fit))
            first = first or options
            new = self._best(fit, steps, options)
            if new is None and self._likelihood.has_large_residual(fit):
                new = self._best_pair(fit, steps, options)
            if new is None:
                break
            fit, steps = new
            names = frozenset(step.hypothesis.key for step in steps)
            if names in known:  # what one step adds the next takes away
                break
            known.add(names)
            self._progress(len(steps))
        if first:  # the weights are those of what was tried last, and was not accepted
            fit = self._likelihood.reweighted(fit)
        other, steps = self._exchanged(fit, steps)
        # The last cause was accepted beside exactly these: asked again, a tie would come out by chance.
        fit, steps = self._confirmed(other, steps, asked=len(steps) - 1 if other is fit else len(steps))
        return Found(base, fit, tuple(steps), first)

    def extended(self, found: Found, fit: Fit) -> Found | None:
        """Return what was found with hypotheses that were sought in another way; None unless they are accepted.

        Parameters
        ----------
        found : Found
        fit : Fit
            Its final model, with these as its last.
        """
        fit = self._likelihood.reweighted(fit)
        hypotheses, first = fit.candidate.model.hypotheses, len(found.steps)
        without = [self._likelihood.without(fit, place) for place in range(first, len(hypotheses))]
        more = [Step(one, fit, before, 0.0) for one, before in zip(hypotheses[first:], without, strict=True)]
        accepted = self._accepted(fit, list(found.steps), more)
        return None if accepted is None else replace(found, final=accepted[0], steps=tuple(accepted[1]))

    def possible(self, fit: Fit) -> list[tuple[Fit, float]]:
        """Return a model with one hypothesis more, for all that are not a hundred times less likely than it.

        None that unfitted trials contradict is: no amount of evidence would make it a cause. With each comes what
        it costs [nats]: Schwarz' penalty, and the logarithm of the prior odds against it.
        """
        options = self._likelihood.options(fit)
        kept = [one for one in options if self._log_evidence(one, fit) > -ODDS_NATS and one.helps(fit)]
        number_nats = 0.5 * float(np.log(len(fit.trial)))
        return [
            (one, number_nats * (one.n_number - fit.n_number) + self._against(one.candidate.hypothesis))
            for one in kept
        ]

    def _log_evidence(self, one: Fit, fit: Fit) -> float:
        new = one.candidate.model.hypotheses[len(fit.candidate.model.hypotheses) :]
        return log_evidence(one, fit, sum(map(self._against, new)))

    def _against(self, hypothesis: Hypothesis) -> float:
        """Return the logarithm of the prior odds against a hypothesis at the place where it was found [nats]."""
        families = 1 if hypothesis.kind.usual else self._families
        return self._likelihood.log_places(hypothesis) + float(np.log(families))

    def _promising(self, fit: Fit, options: Sequence[Fit]) -> list[Fit]:
        """Return those that are likelier than not, the likeliest first."""
        kept = [one for one in options if self._log_evidence(one, fit) > 0.0]
        return sorted(kept, key=penalised_log_likelihood, reverse=True)

    def _accepted(self, fit: Fit, steps: list[Step], more: list[Step]) -> tuple[Fit, list[Step]] | None:
        """Return a model with further causes, without those that they make needless.

        None if under its own weights their evidence is too small or they do not help on unfitted trials, or if any
        cause's size is unknown.
        """
        smaller = fit
        for _ in more:
            smaller = self._likelihood.without(smaller, len(smaller.candidate.model.hypotheses) - 1)
        own = self._log_evidence(fit, smaller)
        if own < ODDS_NATS or not fit.helps(smaller) or not self._is_evident_everywhere(fit, smaller):
            return None
        kept, left = self._pruned(fit, [*steps, *(replace(step, log_evidence=own) for step in more)])
        if len(left) < len(steps) + len(more):
            # What has made others needless stands for them: it has the evidence of a cause without them, too.
            kept = self._likelihood.reweighted(kept)
            if not all(self._is_evident(kept, place) for place in range(len(left) - len(more), len(left))):
                return None
        return (kept, left) if self._likelihood.is_significant(kept) else self._disentangled(kept, left)

    def _disentangled(self, fit: Fit, steps: list[Step]) -> tuple[Fit, list[Step]] | None:
        """Return a model with others in place of earlier causes of which one has no size beside the last one.

        What was found first may have stood for two: beside one of them it is collinear, and stands for the other.
        None unless all causes then have evidence, and sizes.
        """
        other, exchanged = self._exchanged(fit, steps)
        if other is fit or not self._likelihood.is_significant(other):
            return None
        return (other, exchanged) if all(self._is_evident(other, k) for k in range(len(exchanged))) else None

    def _is_evident(self, fit: Fit, place: int) -> bool:
        """Say whether one of a model's hypotheses has the evidence of a cause beside the others."""
        smaller, against = (
            self._likelihood.without(fit, place),
            self._against(fit.candidate.model.hypotheses[place]),
        )
        return log_evidence(fit, smaller, against) >= ODDS_NATS

    def _is_evident_everywhere(self, fit: Fit, smaller: Fit) -> bool:
        """Say whether what a model has more has the evidence of a cause where both are fitted to all trials, too.

        What a smaller model leaves of unfitted trials, because the learning trials determine its numbers poorly,
        is no cause; nor is what an event's model leaves less of them, because it is fitted to all trials.
        """
        if np.all(fit.learnt):
            return True
        both = self._likelihood.everywhere(fit), self._likelihood.everywhere(smaller)
        return self._log_evidence(*both) >= ODDS_NATS

    def _best(self, fit: Fit, steps: list[Step], options: tuple[Fit, ...]) -> tuple[Fit, list[Step]] | None:
        """Return the likeliest model of sufficient evidence under its own weights, with the steps to it."""
        kept = self._promising(fit, options)
        while kept:
            found, step = self._best_of(fit, kept, options)
            if accepted := self._accepted(found, steps, [step]):
                return accepted
            kept = [one for one in kept if one is not step.fit]
        return None

    def _best_of(self, fit: Fit, kept: Sequence[Fit], options: tuple[Fit, ...]) -> tuple[Fit, Step]:
        """Return the likeliest of some models under its own weights; of equals that of fewest numbers."""
        # What gains clearly less than the best is a weaker cause and no other name for it.
        best = kept[0]
        close = [one for one in kept if one is best or CLEAR_RATIO * one.gain(fit) > best.gain(fit)]
        for _ in close:
            settled = self._likelihood.reweighted(best)
            last = len(settled.candidate.model.hypotheses) - 1
            tried = [(one, self._likelihood.instead(settled, last, one)) for one in close if one is not best]
            rivals = [(one, rival) for one, rival in tried if rival is not None]
            beating = [one for one, rival in rivals if is_better(rival, settled)]
            if not beating:
                break
            best, close = beating[0], [one for one in close if one is not best]
        equal = [(best, settled), *((one, rival) for one, rival in rivals if not is_better(settled, rival))]
        fewest = min(rival.n_number for _, rival in equal)
        chosen, found = next((one, rival) for one, rival in equal if rival.n_number == fewest)
        if chosen is not best:
            found = self._likelihood.reweighted(chosen)
        others = tuple(one for one, _ in equal if one is not chosen)
        return found, Step(
            chosen.candidate.hypothesis, chosen, fit, self._log_evidence(chosen, fit), others, options
        )

    def _best_pair(self, fit: Fit, steps: list[Step], options: Sequence[Fit]) -> tuple[Fit, list[Step]] | None:
        """Return the likeliest model with two hypotheses more neither of which has sufficient evidence alone."""
        pairs = [self._likelihood.joined(fit, pair) for pair in combinations(options[:N_REFINED], 2)]
        kept = self._promising(fit, [pair for pair in pairs if pair is not None])
        if not kept:
            return None
        own, new = self._log_evidence(kept[0], fit), kept[0].candidate.model.hypotheses[-2:]
        more = [Step(hypothesis, kept[0], fit, own, options=tuple(options)) for hypothesis in new]
        return self._accepted(self._likelihood.reweighted(kept[0]), steps, more)

    def _pruned(self, fit: Fit, steps: list[Step]) -> tuple[Fit, list[Step]]:
        """Return a model without the causes that the last one has made needless."""
        for place in reversed(range(len(steps) - 1)):
            if not self._is_evident(fit, place):
                fit = self._likelihood.without(fit, place)
                steps = [one for k, one in enumerate(steps) if k != place]
        return fit, steps

    def _exchanged(self, fit: Fit, steps: list[Step]) -> tuple[Fit, list[Step]]:
        """Return a model whose earlier causes are compared again with all others, given those found after them.

        What stood in for two causes as long as none of them was known may be the wrong one given the other.
        """
        for step in steps[:-1]:
            place = steps.index(step)
            options = tuple(self._likelihood.options(self._likelihood.without(fit, place)))
            better = next((one for one in options if _is_preferred(one, fit)), None)
            if better is not None and better.candidate.hypothesis.key != step.hypothesis.key:
                new = replace(step, hypothesis=better.candidate.hypothesis, fit=better, equals=(), options=options)
                fit, steps = self._likelihood.reweighted(better), [*steps[:place], *steps[place + 1 :], new]
        return fit, steps

    def _confirmed(self, fit: Fit, steps: list[Step], asked: int) -> tuple[Fit, list[Step]]:
        """Return a model without the causes that trials not learnt from contradict, now that all are in.

        The first ``asked`` are asked for; once one has gone, all of those that remain.
        """
        while asked > 0:
            smaller = [self._likelihood.without(fit, place) for place in range(asked)]
            contradicted = [place for place in range(asked) if not fit.helps(smaller[place])]
            if not contradicted:
                break
            weakest = min(contradicted, key=lambda place: fit.held_out(smaller[place]))
            fit = self._likelihood.reweighted(smaller[weakest])
            steps = [one for k, one in enumerate(steps) if k != weakest]
            asked = len(steps)
        return fit, steps


def _is_preferred(one: Fit, other: Fit) -> bool:
    """Say whether a model is better, or as good with fewer numbers."""
    return is_better(one, other) or (one.n_number < other.n_number and not is_better(other, one))
