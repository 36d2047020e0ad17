"""Every hypothesis tried in addition to what is accepted: first on a grid of psi, the promising ones then refined.

Each is tried for itself, so several processors share them.
"""

from collections.abc import Callable, Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import CLEAR_RATIO, N_REFINED, NEGLIGIBLE, UNEXPLAINED
from fitter.diagnosis.model import Candidate, Hypothesis, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.multistart import Best, Multistart
from fitter.diagnosis.payload import find_payloads
from fitter.diagnosis.refinement import Starts, by_learning, fitted
from fitter.diagnosis.regression import Regression
from fitter.parallel.forked import side_by_side


def screen(
    regression: Regression,
    accepted: Candidate,
    tried: Sequence[Hypothesis],
    starts: Starts,
    progress: Callable[[int, int], None] | None = None,
) -> list[Candidate]:
    """Return all hypotheses, each fitted with what is accepted, the most explaining first.

    Parameters
    ----------
    regression : Regression
    accepted : Candidate
        What they are added to.
    tried : sequence of Hypothesis
        Those that are no events; these are found here.
    starts : Starts
        With which the search for psi begins; what does best is added.
    progress : callable, optional
        Called with how many are done, and how many there are.
    """
    motions = _telling(regression, accepted)
    grid = Multistart(regression, accepted.model, starts, motions)

    def best_start(hypothesis: Hypothesis) -> Best:
        with regression.forgetting():
            return grid.best(hypothesis)

    first = side_by_side(best_start, tried, progress)
    happened = events(regression, accepted.model)
    explained = np.array([one.gain for one in first])
    best = float(explained.max(initial=0.0))
    rank = np.argsort(np.argsort(-explained))
    held = len(accepted.model.hypotheses)
    numbers = {motion.number for motion in motions}
    learnt = [motion.number in numbers for motion in regression.motions]

    def as_lasting(k: int) -> Candidate:
        model, gain = accepted.model.plus(tried[k], first[k].psi), first[k].gain
        if gain < NEGLIGIBLE * max(grid.chi2 / len(motions), best):  # of a trial's residual
            return Candidate(model, accepted.x, accepted.squares)
        # What explains clearly less than the best one is no rival, unless it is among the first ranks.
        refine = gain >= UNEXPLAINED * grid.chi2 and (CLEAR_RATIO * gain >= best or rank[k] < N_REFINED)
        candidate = fitted(regression, model, refine, held)
        gained = float((accepted.squares - candidate.squares)[learnt].sum())
        # The grid's gain is with accepted psi that give way.
        if refine and rank[k] < N_REFINED and len(accepted.model.flat) and gained < gain:
            free = fitted(regression, candidate.model)
            candidate = min(candidate, free, key=lambda one: float(one.squares.sum()))
        return by_learning(regression, candidate) if candidate.model.is_event else candidate

    candidates = fitted_all(regression, as_lasting, accepted, tried)
    for one, candidate in zip(first, candidates, strict=True):
        starts.keep(accepted.model, candidate.hypothesis, np.vstack([candidate.model.psi[-1], one.best]))
    leading = min((float(one.squares.sum()) for one in candidates), default=float(accepted.squares.sum()))

    def as_event(k: int) -> Candidate:
        candidate = fitted(regression, accepted.model.plus(happened[k], happened[k].starts([])[0]), refine=False)
        candidate = by_learning(regression, candidate)
        gain = float(accepted.squares.sum() - candidate.squares.sum())
        if gain > max(UNEXPLAINED * accepted.squares.sum(), (accepted.squares.sum() - leading) / CLEAR_RATIO):
            candidate = by_learning(regression, fitted(regression, candidate.model, held=held))
        return candidate

    candidates += fitted_all(regression, as_event, accepted, happened)
    possible = [one if _possible(one) else Candidate(one.model, one.x, accepted.squares) for one in candidates]
    return sorted(possible, key=lambda one: float(one.squares.sum()))


def _telling(regression: Regression, accepted: Candidate) -> list[Motion]:
    """Return the trials that hypotheses are begun with: those that may be learnt from.

    Where these are all, they are the learning trials and as many others, those with the largest residuals.
    """
    motions = regression.motions_of(accepted.model)
    ratio = accepted.squares / regression.n_effective
    judging = [k for k in np.argsort(-ratio) if not regression.motions[k].learn]
    kept = {regression.motions[k].number for k in judging[: len(regression.motions) - len(judging)]}
    return [motion for motion in motions if motion.learn or motion.number in kept]


def fitted_all(
    regression: Regression, fit: Callable[[int], Candidate], accepted: Candidate, hypotheses: Sequence[Hypothesis]
) -> list[Candidate]:
    """Return each hypothesis fitted with what is accepted: numbers come from other processes, no objects.

    Parameters
    ----------
    regression : Regression
    fit : callable
        Fits the k-th hypothesis as a model's last, behind all that are accepted.
    accepted : Candidate
    hypotheses : sequence of Hypothesis
    """

    def numbers(k: int) -> tuple[tuple[Floats, ...], Floats, Floats | None]:
        with regression.forgetting():
            candidate = fit(k)
        untouched = candidate.squares is accepted.squares
        return candidate.model.psi, candidate.x, None if untouched else candidate.squares

    found, before = side_by_side(numbers, range(len(hypotheses))), accepted.model.hypotheses
    return [
        Candidate(Model((*before, hypothesis), psi), x, accepted.squares if squares is None else squares)
        for hypothesis, (psi, x, squares) in zip(hypotheses, found, strict=True)
    ]


def _possible(candidate: Candidate) -> bool:
    hypothesis = candidate.hypothesis
    factors = candidate.x[len(candidate.x) - hypothesis.n_column :]
    return hypothesis.possible(candidate.model.psi[-1], factors)


def events(regression: Regression, model: Model) -> list[Hypothesis]:
    """Return loads; pushes are found in the missing torque, once the causes that always act are known."""
    return find_payloads(regression, model)
