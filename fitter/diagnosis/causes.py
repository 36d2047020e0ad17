"""Causes, one at a time: the best is accepted beside those before it, then all are doubted again.

Two effects may hide each other, so after every acceptance all psi are fitted anew, and each cause is held against
every rival given the others: one that is no longer needed goes, one that a rival beats is replaced, and rivals
that do as well stand beside it.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.folds import Folds
from fitter.diagnosis.grid import Starts
from fitter.diagnosis.hypotheses import EVENTS
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate, fitted, fitted_all, screen
from fitter.diagnosis.search import UNEXPLAINED_AT_LEAST, Cause, Search
from fitter.diagnosis.unknown import best_functions
from fitter.diagnosis.worth import best_of, more_to_find, reach, simplest, worth_it

Progress = Callable[[str, float], None]
#: An effect's name and its joints.
Key = tuple[str, tuple[int, ...]]

#: No more causes than this are sought.
_MOST = 3
#: If causes leave so large a share of what the base model leaves, so many others are begun with that explain the
#: next share of what the best one does alone, and believed if they leave the last share of what that led to.
_LEADS_NOWHERE, _OTHERS, _BEGINNING, _MUCH_BETTER = 0.05, 2, 0.2, 0.5


def find_causes(
    regression: Regression,
    tried: Sequence[Hypothesis],
    starts: Starts | None = None,
    progress: Progress | None = None,
) -> Search:
    """Find the causes of what a base model leaves.

    Two causes that explain little one by one may explain all together, with the best single one not among them: if
    that leads nowhere, the next best are begun with.

    Parameters
    ----------
    regression : Regression
    tried : sequence of Hypothesis
    starts : Starts, optional
        What another search over the same motions has left.
    progress : callable, optional
        Told what is being done, and how much of all is done (0 to 1).
    """
    told = np.array([regression.weighting.told(motion) for motion in regression.motions], dtype=np.float64)
    base, starts = fitted(regression, Model()), starts or Starts()
    search = _Ascent(regression, tried, starts, base, told, _part(progress, 0.0, 0.5)).from_base()
    if search.may_be_outdone:
        function = best_functions(Folds(regression, base), regression.arm.n_joint).least
        search = replace(search, function=function)
    for k, other in enumerate(_others(search)):
        if search.outdone or not search.leaves(_LEADS_NOWHERE, UNEXPLAINED_AT_LEAST):
            break
        again = _Ascent(regression, tried, starts, base, told, _part(progress, 0.5 + 0.25 * k, 0.25))
        found = again.beginning_with(search.first, other)
        if found.final.squares.sum() < _MUCH_BETTER * search.final.squares.sum():
            search = replace(found, function=search.function)
    return search


def _part(progress: Progress | None, begin: float, share: float) -> Progress:
    return lambda what, done: progress(what, begin + share * done) if progress else None


def _others(search: Search) -> list[Candidate]:
    """Return the best of every other effect that explained something beside the base model alone."""
    begun = {hypothesis.kind.name for hypothesis in search.final.model.hypotheses}
    least = _BEGINNING * (search.base.squares.sum() - search.first[0].squares.sum()) if search.first else 0.0
    others: list[Candidate] = []
    for one in search.first:
        name = one.hypothesis.kind.name
        if name not in begun and name not in EVENTS and search.base.squares.sum() - one.squares.sum() > least:
            begun.add(name)
            others.append(one)
    return others[:_OTHERS]


class _Ascent:
    """One way up: a cause at a time, and after every one all are doubted again."""

    def __init__(
        self,
        regression: Regression,
        tried: Sequence[Hypothesis],
        starts: Starts,
        base: Candidate,
        told: Floats,
        progress: Progress,
    ) -> None:
        self._regression, self._tried, self._base, self._told = regression, tried, base, told
        self._starts = starts
        self._progress = progress
        self._rounds = 0

    def from_base(self) -> Search:
        """Begin with what explains most."""
        if not more_to_find(self._base, self._base, self._told):
            return Search(self._base, self._base, [], [], self._told)
        return self._on(self._screened(self._base))

    def beginning_with(self, first: list[Candidate], candidate: Candidate) -> Search:
        """Begin with another candidate of a screening than the best."""
        return self._on([candidate, *(one for one in first if one is not candidate)], candidate)

    def _screened(self, accepted: Candidate) -> list[Candidate]:
        tried = _without(self._tried, accepted.model)
        candidates = screen(self._regression, accepted, tried, self._starts, self._say("trying every effect"))
        self._rounds += 1
        return candidates

    def _say(self, what: str) -> Callable[[int, int], None]:
        begin, end = 1.0 - 0.5**self._rounds, 1.0 - 0.5 ** (self._rounds + 1)
        return lambda done, total: self._progress(what, begin + (end - begin) * done / total)

    def _on(self, candidates: list[Candidate], best: Candidate | None = None) -> Search:
        regression, base, told, first = self._regression, self._base, self._told, candidates
        accepted = base
        causes: list[Cause] = []
        promising: set[Key] = set()
        known: set[frozenset[Key]] = set()
        while True:
            promising |= {one.hypothesis.key for one in candidates if one.squares is not accepted.squares}
            best = best or best_of(regression, base, accepted, candidates, told)
            if best is None:
                break
            refit = accepted.model.hypotheses or best.model.is_event
            accepted = fitted(regression, best.model) if refit else best
            causes.append(_cause(accepted, len(causes), candidates, best, _before(regression, accepted), told))
            if len(causes) > 1:
                # What has no psi is as quickly tried as put aside.
                again = [one for one in self._tried if one.key in promising or not len(one.low)]
                accepted, causes = _doubted(
                    regression, base, accepted, again, self._starts, told, self._say("doubting every cause")
                )
                self._rounds += 1
            found = frozenset(one.key for one in accepted.model.hypotheses)
            if found in known:  # what one round takes in the next throws out
                break
            known.add(found)
            if len(causes) >= _MOST or not more_to_find(base, accepted, told):
                break
            candidates, best = self._screened(accepted), None
        return Search(base, accepted, causes, first, told)


def _before(regression: Regression, accepted: Candidate) -> float:
    return float(fitted(regression, accepted.model.without(len(accepted.model.hypotheses) - 1)).squares.sum())


def _without(tried: Sequence[Hypothesis], model: Model) -> list[Hypothesis]:
    known = {hypothesis.key for hypothesis in model.hypotheses}
    return [one for one in tried if one.key not in known]


def _cause(
    accepted: Candidate, place: int, candidates: Sequence[Candidate], best: Candidate, base: float, told: Floats
) -> Cause:
    """Return a cause with those that do as well with no more numbers, and those that don't."""
    worth = base - float(accepted.squares.sum())
    most = reach(best, worth, told)
    rivals = [
        one
        for one in candidates
        if one is not best
        and one.hypothesis.n_number <= best.hypothesis.n_number
        and float(one.squares.sum()) <= most
    ]
    beaten = [one for one in candidates if one is not best and one not in rivals]
    return Cause(place, rivals, beaten, worth)


def _with_itself(
    regression: Regression, rest: Candidate, candidates: list[Candidate], itself: Candidate, told: Floats
) -> list[Candidate]:
    """Return candidates with the doubted one as it was, unless it did better when it was tried anew.

    The others' psi are held where they are without it, which may be far from where they are with it: what did as
    well as it there is fitted anew from where they are with it, for it may do as well here, too.
    """
    anew = next((one for one in candidates if one.hypothesis.key == itself.hypothesis.key), None)
    if anew is not None and anew.squares.sum() <= itself.squares.sum():
        return candidates
    most = reach(anew, float(rest.squares.sum() - anew.squares.sum()), told) if anew is not None else -np.inf
    before, psi = itself.model.hypotheses[:-1], itself.model.psi[:-1]
    others = [one for one in candidates if one is not anew]

    def refitted(k: int) -> Candidate:
        one = others[k]
        if one.squares.sum() > most:
            return one
        return fitted(regression, Model((*before, one.hypothesis), (*psi, one.model.psi[-1])))

    others = fitted_all(regression, refitted, rest, [one.hypothesis for one in others])
    return sorted([itself, *others], key=lambda one: float(one.squares.sum()))


def _doubted(
    regression: Regression,
    base: Candidate,
    accepted: Candidate,
    tried: Sequence[Hypothesis],
    starts: Starts,
    told: Floats,
    say: Callable[[int, int], None],
) -> tuple[Candidate, list[Cause]]:
    """Hold each cause against all others given the rest."""
    causes: list[Cause] = []
    k = 0
    while k < len(accepted.model.hypotheses):
        rest = fitted(regression, accepted.model.without(k))
        candidates = screen(regression, rest, _without(tried, rest.model), starts, say)
        itself = fitted(regression, accepted.model.with_last(k), refine=False)
        candidates = _with_itself(regression, rest, candidates, itself, told)
        best = simplest(rest, candidates, told)
        assert best is not None
        if not worth_it(regression, base, rest, best, told):
            accepted = rest
            continue
        model = best.model
        order = [*range(k), len(model.hypotheses) - 1, *range(k, len(model.hypotheses) - 1)]
        model = Model(tuple(model.hypotheses[i] for i in order), tuple(model.psi[i] for i in order))
        accepted = fitted(regression, model)
        causes.append(_cause(accepted, k, candidates, best, float(rest.squares.sum()), told))
        k += 1
    return accepted, causes
