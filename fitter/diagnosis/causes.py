"""Causes of what a base model leaves: up from the best hypothesis, and from others where that leads nowhere."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

from fitter.diagnosis.ascent import Ascent, Progress
from fitter.diagnosis.folds import Folds
from fitter.diagnosis.hypotheses import EVENTS
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate, fitted
from fitter.diagnosis.search import Search
from fitter.diagnosis.starts import Starts
from fitter.diagnosis.unknown import best_functions
from fitter.diagnosis.worth import best_of, more_to_find

#: If causes lead nowhere, so many others are begun with that explain this share of what the best one does alone,
#: and believed if they leave the last share of what that led to.
_OTHERS, _BEGINNING, _MUCH_BETTER = 2, 0.2, 0.5


@dataclass(frozen=True)
class Beginning:
    """The base model, every hypothesis beside it alone (none if it leaves nothing), and the best if worth it."""

    base: Candidate
    candidates: list[Candidate]
    best: Candidate | None


def begin(regression: Regression, tried: Sequence[Hypothesis], starts: Starts, progress: Progress) -> Beginning:
    """Try every hypothesis beside the base model alone; see `find_causes`."""
    base, told = fitted(regression, Model()), regression.told
    if not more_to_find(base, base, told):
        return Beginning(base, [], None)
    first = Ascent(regression, tried, starts, base, progress).screened(base)
    return Beginning(base, first, best_of(regression, base, base, first, told))


def find_causes(
    regression: Regression,
    tried: Sequence[Hypothesis],
    starts: Starts | None = None,
    progress: Progress | None = None,
    begun: Beginning | None = None,
    before: Search | None = None,
    strict: bool = False,
    is_right: Callable[[Candidate], bool] | None = None,
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
    before : Search, optional
        What was found with another filter: several causes that explained nearly all are gone on from.
    strict : bool
        Whether no more causes are sought where one unknown function explains clearly more than several do: none
        of them will be named.
    is_right : callable, optional
        Whether the filter is, under a model: where several causes explain nearly all, and it is not, no more are
        sought, for the search will be made anew.
    """
    starts = starts or Starts()
    part = _part(progress, 0.0, 0.5)
    begun = begun or begin(regression, tried, starts, part)
    base = begun.base
    search = Search(base, base, [], [], regression.told)

    @cache
    def function() -> float:
        return best_functions(Folds(regression, base), regression.arm.n_joint).least

    def ascent(part: Progress) -> Ascent:
        return Ascent(regression, tried, starts, base, part, function if strict else None, is_right)

    if begun.candidates and before is not None and before.is_nearly_all:
        search = ascent(part).from_causes(begun.candidates, before.final.model)
    if begun.candidates and (not search.causes or search.leads_nowhere):
        anew = ascent(part).on(begun.candidates, begun.best)
        search = min(anew, search, key=lambda one: float(one.final.squares.sum()))
    if search.may_be_outdone:
        search = replace(search, function=function())
    for k, other in enumerate(_others(search)):
        if search.outdone or not search.leads_nowhere:
            break
        again = ascent(_part(progress, 0.5 + 0.25 * k, 0.25))
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
