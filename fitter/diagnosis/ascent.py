"""One way up to the causes: the best is accepted beside those before it, then all are doubted again.

Two effects may hide each other, so after every acceptance all psi are fitted anew, and each cause is held against
every rival given the others: one that is no longer needed goes, one that a rival beats is replaced, and rivals
that do as well stand beside it.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from arm.model import Floats
from fitter.diagnosis.grid import Grid
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import PROMISING, Candidate, fitted, fitted_all, screen
from fitter.diagnosis.search import Cause, Search
from fitter.diagnosis.starts import Starts
from fitter.diagnosis.unseen import shows_only_where_it_is_judged
from fitter.diagnosis.worth import best_of, more_to_find, reach, rivals_of, simplest, worth_it

Progress = Callable[[str, float], None]
#: An effect's name and its joints.
Key = tuple[str, tuple[int, ...]]

#: No more causes than this are sought.
_MOST = 3
#: Left with so many times what it was before, a model is the same as before: what was tried beside it need not be
#: tried again.
_AS_BEFORE = 1.001
#: All trials tell what learning trials don't if they leave this share of what those do.
_BY_ALL = 0.5


class Ascent:
    """One way up: a cause at a time, and after every one all are doubted again.

    ``function`` tells what one unknown function would leave (`Search.function`): where several causes leave
    clearly more, no other is sought. It is asked only if they may. ``is_right`` says whether the filter is, under
    a model: where several causes explain nearly all, and it is not, no more is sought with it.
    """

    def __init__(
        self,
        regression: Regression,
        tried: Sequence[Hypothesis],
        starts: Starts,
        base: Candidate,
        progress: Progress,
        function: Callable[[], float] | None = None,
        is_right: Callable[[Candidate], bool] | None = None,
    ) -> None:
        self._regression, self._tried, self._starts, self._base = regression, tried, starts, base
        self._progress, self._rounds, self._function, self._is_right = progress, 0, function, is_right
        #: What everything was tried beside, by its hypotheses, and what came of it.
        self._known: dict[tuple[Key, ...], tuple[Candidate, list[Candidate]]] = {}

    def screened(self, accepted: Candidate) -> list[Candidate]:
        """Try everything beside what is accepted."""
        return self._screened(self._regression, accepted, self._starts)

    def _screened(self, regression: Regression, accepted: Candidate, starts: Starts) -> list[Candidate]:
        tried = _without(self._tried, accepted.model)
        candidates = screen(regression, accepted, tried, starts, self._say("trying every effect"))
        self._rounds += 1
        return candidates

    def _next(self, accepted: Candidate) -> tuple[Candidate, list[Candidate], Candidate | None]:
        """Return what is accepted, everything beside it, and the best of that if it is worth it.

        What only the evaluating trials show is learnt from all, from then on.
        """
        told = self._regression.told
        if shows_only_where_it_is_judged(self._regression, self._base, accepted):
            by_all = self._regression.learning_from_all()
            anew = fitted(by_all, accepted.model)
            candidates = self._screened(by_all, anew, Starts())
            best = best_of(by_all, self._base, anew, candidates, told)
            if best is not None:
                self._learn_by(by_all)
                return anew, candidates, best
        candidates = self.screened(accepted)
        self._known[_keys(accepted)] = accepted, candidates
        return accepted, candidates, best_of(self._regression, self._base, accepted, candidates, told)

    def _say(self, what: str) -> Callable[[int, int], None]:
        begin, end = 1.0 - 0.5**self._rounds, 1.0 - 0.5 ** (self._rounds + 1)
        return lambda done, total: self._progress(what, begin + (end - begin) * done / total)

    def _learn_by(self, by_all: Regression) -> None:
        self._regression = by_all
        self._starts.forget()
        self._known.clear()

    def on(self, first: list[Candidate], best: Candidate | None) -> Search:
        """Go on from everything beside the base model, with one of it as the first cause."""
        self._rounds = 1
        return self._higher(first, self._base, [], first, best)

    def from_causes(self, first: list[Candidate], model: Model) -> Search:
        """Go on from causes that another search has found, once each of them is doubted."""
        self._rounds = 1
        accepted, causes = self._doubted(fitted(self._regression, model), _explaining(first, self._base))
        if self._ends(accepted, causes, first):
            return self._come_to(accepted, causes, first)
        accepted, candidates, best = self._next(accepted)
        return self._higher(first, accepted, causes, candidates, best)

    def _higher(
        self,
        first: list[Candidate],
        accepted: Candidate,
        causes: list[Cause],
        candidates: list[Candidate],
        best: Candidate | None,
    ) -> Search:
        promising = _explaining(first, self._base)
        known = {frozenset(_keys(accepted))} if causes else set()
        while best is not None:
            promising |= _explaining(candidates, accepted)
            refit = accepted.model.hypotheses or best.model.is_event
            accepted = fitted(self._regression, best.model) if refit else best
            without = _before(self._regression, accepted)
            causes = [*causes, _cause(accepted, len(causes), candidates, best, without, self._regression.told)]
            if len(causes) > 1:
                accepted, causes = self._doubted(accepted, promising)
            if frozenset(_keys(accepted)) in known:  # what one round takes in the next throws out
                break
            known.add(frozenset(_keys(accepted)))
            if self._ends(accepted, causes, first):
                break
            accepted, candidates, best = self._next(accepted)
        return self._come_to(accepted, causes, first)

    def _come_to(self, accepted: Candidate, causes: list[Cause], first: list[Candidate]) -> Search:
        regression = self._regression
        return Search(self._base, accepted, causes, first, regression.told, from_all=regression.learns_from_all)

    def _ends(self, accepted: Candidate, causes: Sequence[Cause], first: list[Candidate]) -> bool:
        """Say whether no more causes are sought, or not with this filter."""
        if self._is_at_top(accepted, causes) or self._is_outdone(accepted, causes, first):
            return True
        to_be_made_anew = self._is_right is not None and self._come_to(accepted, list(causes), first).is_nearly_all
        return to_be_made_anew and self._is_right is not None and not self._is_right(accepted)

    def _is_outdone(self, accepted: Candidate, causes: Sequence[Cause], first: list[Candidate]) -> bool:
        """Say whether one unknown function would explain clearly more than several causes do: they are none."""
        found = self._come_to(accepted, list(causes), first)
        if self._function is None or len(causes) < 2 or not found.may_be_outdone:
            return False
        return replace(found, function=self._function()).outdone

    def _is_at_top(self, accepted: Candidate, causes: Sequence[Cause]) -> bool:
        return len(causes) >= _MOST or not more_to_find(self._base, accepted, self._regression.told)

    def _doubted(self, accepted: Candidate, promising: set[Key]) -> tuple[Candidate, list[Cause]]:
        """Hold each cause against all others given the rest."""
        told, say = self._regression.told, self._say("doubting every cause")
        self._rounds += 1
        # What has no psi is as quickly tried as put aside.
        tried = [one for one in self._tried if one.key in promising or not len(one.low)]
        causes: list[Cause] = []
        k = 0
        while k < len(accepted.model.hypotheses):
            regression = self._regression
            # All trials stay: no event is needed for its trials to be learnt from.
            rest = fitted(regression, accepted.model.without(k), to_all=accepted.model.is_event)
            before, candidates = self._known.get(_keys(rest), (rest, []))
            if candidates and before.squares.sum() <= _AS_BEFORE * rest.squares.sum():
                rest = before
            else:
                candidates = screen(regression, rest, _without(tried, rest.model), self._starts, say)
            itself = fitted(regression, accepted.model.with_last(k), refine=False)
            candidates = _with_itself(regression, rest, candidates, itself, self._starts, told)
            best = simplest(rest, candidates, told)
            assert best is not None
            if not worth_it(regression, self._base, rest, best, told):
                accepted = self._back_at(rest) if accepted.model.is_event else rest
                continue
            model = best.model
            order = [*range(k), len(model.hypotheses) - 1, *range(k, len(model.hypotheses) - 1)]
            model = Model(tuple(model.hypotheses[i] for i in order), tuple(model.psi[i] for i in order))
            accepted = fitted(regression, model)
            causes.append(_cause(accepted, k, candidates, best, float(rest.squares.sum()), told))
            k += 1
        return accepted, causes

    def _back_at(self, rest: Candidate) -> Candidate:
        """Return a model without the event that it was fitted to all trials for: to these still where need be."""
        learnt = fitted(self._regression, rest.model)
        if rest.squares.sum() > _BY_ALL * learnt.squares.sum():
            return learnt
        self._learn_by(self._regression.learning_from_all())
        return rest


def _explaining(candidates: Sequence[Candidate], beside: Candidate) -> set[Key]:
    return {one.hypothesis.key for one in candidates if one.squares is not beside.squares}


def _keys(accepted: Candidate) -> tuple[Key, ...]:
    return tuple(one.key for one in accepted.model.hypotheses)


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
    rivals = rivals_of(best, candidates, base, worth, told)
    beaten = [one for one in candidates if one is not best and one not in rivals]
    return Cause(place, rivals, beaten, worth)


def _with_itself(
    regression: Regression,
    rest: Candidate,
    candidates: list[Candidate],
    itself: Candidate,
    starts: Starts,
    told: Floats,
) -> list[Candidate]:
    """Return candidates with the doubted one as it was, unless it did better when it was tried anew.

    The others' psi are held where they are without it, which may be far from where they are with it: what did as
    well as it there may do as well here, too, and is fitted anew from here if it promises to.
    """
    anew = next((one for one in candidates if one.hypothesis.key == itself.hypothesis.key), None)
    if anew is not None and anew.squares.sum() <= itself.squares.sum():
        return candidates
    most = reach(anew, float(rest.squares.sum() - anew.squares.sum()), told) if anew is not None else -math.inf
    before, psi = itself.model.hypotheses[:-1], itself.model.psi[:-1]
    others = [one for one in candidates if one is not anew]
    if any(one.squares.sum() <= most for one in others):
        grid = Grid(regression, Model(before, psi), starts)
        promised = PROMISING * grid.gain(itself.hypothesis, itself.model.psi[-1])

        def refitted(k: int) -> Candidate:
            one = others[k]
            if one.squares.sum() > most:
                return one
            best = grid.best(one.hypothesis)
            if best.gain < promised:
                return one
            return fitted(regression, Model((*before, one.hypothesis), (*psi, best.psi)))

        others = fitted_all(regression, refitted, rest, [one.hypothesis for one in others])
    return sorted([itself, *others], key=lambda one: float(one.squares.sum()))
