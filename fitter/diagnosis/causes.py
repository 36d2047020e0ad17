"""Causes, one at a time: the best is accepted beside those before it, then all are doubted again.

Two effects may hide each other, so after every acceptance all psi are fitted anew, and each cause is held against
every rival given the others: one that is no longer needed goes, one that a rival beats is replaced, and rivals
that do as well stand beside it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from arm.model import Floats
from fitter.diagnosis.hypotheses import EVENTS
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.regression import Model, Regression
from fitter.diagnosis.screening import Candidate, fitted, screen

Progress = Callable[[str, float], None]

#: A cause must lower the sum of squares by this share of the number of equations (noise would leave one each). In
#: 13 runs without effect (seeds 6000 to 6012 of the hidden arms) no cause that always acts explained more than
#: 0.002 of it.
WORTH_OF_NOISE = 0.05
#: … and absolutely by this, for among hundreds of starts the best one explains some noise (of one a number).
WORTH_AT_LEAST = 50.0
#: An event can be found for anything: pushes explained up to 0.031 there.
WORTH_OF_EVENTS = 0.3
#: … and by this share of all that the base model leaves beyond noise.
WORTH_OF_ALL = 0.002
#: … or this share of it beside a play, for how its motor crosses nobody can see.
WORTH_BESIDE_PLAY = 0.1
#: Beside other causes it must explain this share of what these leave, and this share of the number of equations: a
#: formula that is not quite right leaves something too, of which many an effect explains a part.
WORTH_OF_LEFT, WORTH_OF_NEXT, WORTH_OF_NEXT_EVENT = 0.4, 0.3, 3.0
#: A cause that acts in every trial must help in the evaluating ones, by so many standard errors.
_SURE = 3.0
#: … or in this share of them, or explain half of what they leave: where a few trials gain very much, the standard
#: error is no measure.
_MOSTLY, _HALF = 0.8, 0.5
#: A rival is its equal if it leaves at most so much more, as a share of the number of equations (the noise is not
#: known better than that) …
_EQUAL, _EQUAL_AT_MOST = 0.01, 0.1
#: … or as a share of what the cause explains, since no catalogue's formula is exact, but not above the second
#: share of that number or half of what the best leaves beyond noise itself.
_ALIKE = 0.025
_MOST = 3
#: Noise leaves at least this share of what was expected of it, though its size is only estimated.
_SURELY_NOISE = 0.6


@dataclass(frozen=True)
class Cause:
    """One accepted hypothesis.

    Attributes
    ----------
    place : int
        Its place in the model.
    rivals : list of Candidate
        Others that would explain as much in its stead; the model with each.
    beaten : list of Candidate
        All others that were tried in its stead, best first.
    worth : float
        By how much the sum of squares grows without it.
    """

    place: int
    rivals: list[Candidate] = field(default_factory=list)
    beaten: list[Candidate] = field(default_factory=list)
    worth: float = 0.0


@dataclass(frozen=True)
class Search:
    """What the search for causes has come to.

    Attributes
    ----------
    base, final : Candidate
        Without and with all causes.
    causes : list of Cause
    first : list of Candidate
        Every hypothesis beside the base model alone, best first.
    told : (n_trial,)
        How many numbers each trial tells: what noise alone would leave.
    """

    base: Candidate
    final: Candidate
    causes: list[Cause]
    first: list[Candidate]
    told: Floats

    @property
    def structure(self) -> float:
        """What the base model leaves beyond noise, as a share of the noise."""
        return float((self.base.squares.sum() - self.noise) / self.noise)

    @property
    def noise(self) -> float:
        """The sum of squares that noise alone leaves, not more than anything has left."""
        return float(min(self.told.sum(), self.final.squares.sum()))

    @property
    def explained(self) -> float:
        """Share of that structure which the causes explain, 0 to 1."""
        beyond = self.base.squares.sum() - self.noise
        return float(np.clip((self.base.squares.sum() - self.final.squares.sum()) / max(beyond, 1e-300), 0.0, 1.0))


def find_causes(regression: Regression, tried: Sequence[Hypothesis], progress: Progress | None = None) -> Search:
    """Find the causes of what a base model leaves.

    Parameters
    ----------
    regression : Regression
    tried : sequence of Hypothesis
    progress : callable, optional
        Told what is being done, and how much of all is done (0 to 1).
    """
    told = np.array([regression.weighting.told(motion) for motion in regression.motions], dtype=np.float64)
    base = fitted(regression, Model())
    accepted, rounds = base, 0
    first: list[Candidate] = []
    causes: list[Cause] = []
    promising: set[tuple[str, tuple[int, ...]]] = set()
    known: set[frozenset[tuple[str, tuple[int, ...]]]] = set()

    def say(what: str) -> Callable[[int, int], None]:
        begin, end = 1.0 - 0.5**rounds, 1.0 - 0.5 ** (rounds + 1)
        return lambda done, total: progress(what, begin + (end - begin) * done / total) if progress else None

    while len(causes) < _MOST and _more_to_find(base, accepted, told):
        candidates = screen(regression, accepted, _without(tried, accepted.model), say("trying every effect"))
        first = first or candidates
        promising |= {one.hypothesis.key for one in candidates if one.squares is not accepted.squares}
        rounds += 1
        best = _simplest(accepted, candidates, told)
        if best is not None and not _worth_it(regression, base, accepted, best, told):
            lasting = [one for one in candidates if one.hypothesis.kind.name not in EVENTS]
            best = _simplest(accepted, lasting, told)
        if best is None or not _worth_it(regression, base, accepted, best, told):
            break
        refit = accepted.model.hypotheses or best.model.is_event
        accepted = fitted(regression, best.model) if refit else best
        causes.append(_cause(accepted, len(causes), candidates, best, _before(regression, accepted), told))
        if len(causes) == 1:
            known.add(frozenset(one.key for one in accepted.model.hypotheses))
        else:
            again = [one for one in tried if one.key in promising]
            accepted, causes, rounds = _doubted(regression, base, accepted, again, told, rounds, say)
            found = frozenset(one.key for one in accepted.model.hypotheses)
            if found in known:  # what one round takes in the next throws out
                break
            known.add(found)
    return Search(base, accepted, causes, first, told)


def _before(regression: Regression, accepted: Candidate) -> float:
    return float(fitted(regression, accepted.model.without(len(accepted.model.hypotheses) - 1)).squares.sum())


def _without(tried: Sequence[Hypothesis], model: Model) -> list[Hypothesis]:
    known = {hypothesis.key for hypothesis in model.hypotheses}
    return [one for one in tried if one.key not in known]


def _simplest(accepted: Candidate, candidates: Sequence[Candidate], told: Floats) -> Candidate | None:
    """Return the one with fewest numbers among those that are equal to the best."""
    if not candidates:
        return None
    equal = _equals(accepted, candidates, told)
    return min(equal, key=lambda one: (one.hypothesis.n_number, float(one.squares.sum())))


def _equals(accepted: Candidate, candidates: Sequence[Candidate], told: Floats) -> list[Candidate]:
    best = candidates[0]
    gain = float(accepted.squares.sum() - best.squares.sum())
    reach = _reach(best, gain, told)
    return [one for one in candidates if float(one.squares.sum()) <= reach]


def _reach(best: Candidate, gain: float, told: Floats) -> float:
    """Return the sum of squares up to which a rival is the best one's equal."""
    left, numbers = float(best.squares.sum()), float(told.sum())
    inexact = max(_EQUAL_AT_MOST * numbers, _HALF * (left - numbers))
    return left + max(_EQUAL * numbers, min(_ALIKE * gain, inexact))


def _more_to_find(base: Candidate, accepted: Candidate, told: Floats) -> bool:
    """Say whether what is left could hide a cause that is worth naming."""
    left = float(accepted.squares.sum())
    beyond = base.squares.sum() - min(told.sum(), left)
    return bool(left - _SURELY_NOISE * told.sum() > max(WORTH_OF_NOISE * told.sum(), WORTH_OF_ALL * beyond))


def _worth_it(regression: Regression, base: Candidate, accepted: Candidate, best: Candidate, told: Floats) -> bool:
    gain = accepted.squares - best.squares
    beyond = base.squares.sum() - min(told.sum(), best.squares.sum())
    worth = WORTH_OF_EVENTS if best.hypothesis.kind.name in EVENTS else WORTH_OF_NOISE
    play = any(hypothesis.kind.name == "backlash" for hypothesis in accepted.model.hypotheses)
    share = WORTH_BESIDE_PLAY if play else WORTH_OF_ALL
    if gain.sum() < max(WORTH_AT_LEAST, worth * told.sum(), share * beyond):
        return False
    left = accepted.squares.sum() - told.sum()
    following = WORTH_OF_NEXT_EVENT if worth == WORTH_OF_EVENTS else WORTH_OF_NEXT
    if accepted.model.hypotheses and gain.sum() < max(following * told.sum(), WORTH_OF_LEFT * left):
        return False
    if best.hypothesis.is_event:
        return True
    judging = [not motion.learn for motion in regression.motions]
    held_out = gain[judging]
    if len(held_out) < 2:
        return True
    surely = held_out.mean() > _SURE * held_out.std(ddof=1) / np.sqrt(len(held_out))
    half = held_out.sum() > _HALF * (accepted.squares - told)[judging].sum()
    return bool(surely or half or np.mean(held_out > 0.0) >= _MOSTLY)


def _cause(
    accepted: Candidate, place: int, candidates: Sequence[Candidate], best: Candidate, base: float, told: Floats
) -> Cause:
    """Return a cause with those that do as well with no more numbers, and those that don't."""
    worth = base - float(accepted.squares.sum())
    reach = _reach(best, worth, told)
    rivals = [
        one
        for one in candidates
        if one is not best
        and one.hypothesis.n_number <= best.hypothesis.n_number
        and float(one.squares.sum()) <= reach
    ]
    beaten = [one for one in candidates if one is not best and one not in rivals]
    return Cause(place, rivals, beaten, worth)


def _doubted(
    regression: Regression,
    base: Candidate,
    accepted: Candidate,
    tried: Sequence[Hypothesis],
    told: Floats,
    rounds: int,
    say: Callable[[str], Callable[[int, int], None]],
) -> tuple[Candidate, list[Cause], int]:
    """Hold each cause against all others given the rest."""
    causes: list[Cause] = []
    k = 0
    while k < len(accepted.model.hypotheses):
        rest = fitted(regression, accepted.model.without(k))
        candidates = screen(regression, rest, _without(tried, rest.model), say("doubting every cause"))
        best = _simplest(rest, candidates, told)
        assert best is not None
        if not _worth_it(regression, base, rest, best, told):
            accepted = rest
            continue
        model = best.model
        order = [*range(k), len(model.hypotheses) - 1, *range(k, len(model.hypotheses) - 1)]
        model = Model(tuple(model.hypotheses[i] for i in order), tuple(model.psi[i] for i in order))
        accepted = fitted(regression, model)
        causes.append(_cause(accepted, k, candidates, best, float(rest.squares.sum()), told))
        k += 1
    return accepted, causes, rounds + 1
