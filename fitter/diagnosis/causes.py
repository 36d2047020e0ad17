"""Causes, one at a time: the best is accepted beside those before it, then all are doubted again.

Two effects may hide each other, so after every acceptance all psi are fitted anew, and each cause is held against
every rival given the others: one that is no longer needed goes, one that a rival beats is replaced, and rivals
that do as well stand beside it.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

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


@dataclass(frozen=True)
class Beginning:
    """The base model, every hypothesis beside it alone (none if it leaves nothing), and the best if worth it."""

    base: Candidate
    candidates: list[Candidate]
    best: Candidate | None


def begin(
    regression: Regression, tried: Sequence[Hypothesis], starts: Starts, progress: Progress
) -> Beginning:
    """Try every hypothesis beside the base model alone; see `find_causes`."""
    base, told = fitted(regression, Model()), regression.told
    if not more_to_find(base, base, told):
        return Beginning(base, [], None)
    first = _Ascent(regression, tried, starts, base, progress).screened(base)
    return Beginning(base, first, best_of(regression, base, base, first, told))


def find_causes(
    regression: Regression,
    tried: Sequence[Hypothesis],
    starts: Starts | None = None,
    progress: Progress | None = None,
    begun: Beginning | None = None,
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
    begun : Beginning, optional
        Of `begin`; it is made here unless given.
    """
    starts = starts or Starts()
    part = _part(progress, 0.0, 0.5)
    begun = begun or begin(regression, tried, starts, part)
    base = begun.base
    search = Search(base, base, [], [], regression.told)
    if begun.candidates:
        search = _Ascent(regression, tried, starts, base, part).on(begun.candidates, begun.best)
    if search.may_be_outdone:
        function = best_functions(Folds(regression, base), regression.arm.n_joint).least
        search = replace(search, function=function)
    for k, other in enumerate(_others(search)):
        if search.outdone or not search.leaves(_LEADS_NOWHERE, UNEXPLAINED_AT_LEAST):
            break
        again = _Ascent(regression, tried, starts, base, _part(progress, 0.5 + 0.25 * k, 0.25))
        found = again.on([other, *(one for one in search.first if one is not other)], other)
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
        progress: Progress,
    ) -> None:
        self._regression, self._tried, self._starts, self._base = regression, tried, starts, base
        self._progress, self._rounds = progress, 0

    def screened(self, accepted: Candidate) -> list[Candidate]:
        """Try everything beside what is accepted."""
        tried = _without(self._tried, accepted.model)
        candidates = screen(self._regression, accepted, tried, self._starts, self._say("trying every effect"))
        self._rounds += 1
        return candidates

    def _say(self, what: str) -> Callable[[int, int], None]:
        begin, end = 1.0 - 0.5**self._rounds, 1.0 - 0.5 ** (self._rounds + 1)
        return lambda done, total: self._progress(what, begin + (end - begin) * done / total)

    def on(self, candidates: list[Candidate], best: Candidate | None) -> Search:
        """Go on from everything beside the base model, with one of it as the first cause."""
        regression, base, told, first = self._regression, self._base, self._regression.told, candidates
        self._rounds = 1
        accepted = base
        causes: list[Cause] = []
        promising: set[Key] = set()
        known: set[frozenset[Key]] = set()
        while best is not None:
            promising |= {one.hypothesis.key for one in candidates if one.squares is not accepted.squares}
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
            candidates = self.screened(accepted)
            best = best_of(regression, base, accepted, candidates, told)
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
    most = reach(anew, float(rest.squares.sum() - anew.squares.sum()), told) if anew is not None else -math.inf
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
