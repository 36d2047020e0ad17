"""When a candidate is worth accepting, which of several that do as well is taken, and which are its equals.

The thresholds were found with runs in which nothing is hidden, not by taste (`docs/diagnosing.md`).
"""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.agreement import apart, disagreement
from fitter.diagnosis.hypotheses import EVENTS
from fitter.diagnosis.pushes import with_free_times
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate, fitted

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
#: Beside other causes it must explain this share of what these leave, and this share of the number of equations: a
#: formula that is not quite right leaves something too, of which many an effect explains a part. In some 50 runs
#: with one effect, play apart (seeds 600000 on), no other that always acts explained more than 0.022 of that
#: number beside it, and no event more than 0.25.
WORTH_OF_LEFT, WORTH_OF_NEXT, WORTH_OF_NEXT_EVENT = 0.4, 0.07, 3.0
#: … or beside a play this share of all that the base model leaves: how its motor crosses nobody can see.
WORTH_BESIDE_PLAY = 0.1
#: A cause that acts in every trial must help in the evaluating ones, by so many standard errors.
_SURE = 3.0
#: … or in this share of them, or explain half of what they leave: where a few trials gain very much, the standard
#: error is no measure.
_MOSTLY, _HALF = 0.8, 0.5
#: A rival is its equal if it leaves at most so much more, as a share of the number of equations (the noise is not
#: known better than that) …
EQUAL, _EQUAL_AT_MOST = 0.01, 0.1
#: … or as a share of what the cause explains, since no catalogue's formula is exact, but not above the second
#: share of that number or half of what the best leaves beyond noise itself.
_ALIKE = 0.025
#: Noise leaves at least this share of what was expected of it, though its size is only estimated.
_SURELY_NOISE = 0.6


def best_of(
    regression: Regression, base: Candidate, accepted: Candidate, candidates: Sequence[Candidate], told: Floats
) -> Candidate | None:
    """Return the candidate to accept, if any is worth it."""
    best = simplest(accepted, candidates, told)
    lasting = simplest(accepted, [one for one in candidates if one.hypothesis.kind.name not in EVENTS], told)
    if best is not None and worth_it(regression, base, accepted, best, told):
        event = best.hypothesis.kind.name in EVENTS
        return _lasting_first(regression, base, accepted, best, lasting, told) if event else best
    return lasting if lasting is not None and worth_it(regression, base, accepted, lasting, told) else None


def _lasting_first(
    regression: Regression,
    base: Candidate,
    accepted: Candidate,
    event: Candidate,
    lasting: Candidate | None,
    told: Floats,
) -> Candidate:
    """Return the better of an event and a cause that always acts, where no trial counts for many.

    A few trials may have what no formula gets right, and pushes then explain more of the squares than the cause
    that shows in all the others.
    """
    if lasting is None or not worth_it(regression, base, accepted, lasting, told):
        return event
    by_event = disagreement(accepted.squares, told) - disagreement(event.squares, told)
    by_lasting = disagreement(accepted.squares, told) - disagreement(lasting.squares, told)
    return lasting if by_lasting > by_event else event


def _settles(event: Candidate, gain: Floats, told: Floats) -> bool:
    """Say whether most of an event's gain is in trials that are then left with no more than others are.

    Where a cause gets single places wrong, a push as short and strong as it likes explains some of that.
    """
    settled = ~apart(event.squares, told)
    return bool(gain[settled].sum() > _HALF * gain.sum())


def simplest(accepted: Candidate, candidates: Sequence[Candidate], told: Floats) -> Candidate | None:
    """Return the one with fewest numbers among those that are equal to the best."""
    if not candidates:
        return None
    equal = _equals(accepted, candidates, told)
    return min(equal, key=lambda one: (one.hypothesis.n_number, float(one.squares.sum())))


def _equals(accepted: Candidate, candidates: Sequence[Candidate], told: Floats) -> list[Candidate]:
    best = candidates[0]
    gain = float(accepted.squares.sum() - best.squares.sum())
    most = reach(best, gain, told)
    return [one for one in candidates if float(one.squares.sum()) <= most]


def reach(best: Candidate, gain: float, told: Floats) -> float:
    """Return the sum of squares up to which a rival is the best one's equal."""
    left, numbers = float(best.squares.sum()), float(told.sum())
    inexact = max(_EQUAL_AT_MOST * numbers, _HALF * (left - numbers))
    return left + max(EQUAL * numbers, min(_ALIKE * gain, inexact))


def rivals_of(
    best: Candidate, candidates: Sequence[Candidate], base: float, worth: float, told: Floats
) -> list[Candidate]:
    """Return those that do as well as the best with no more numbers; what explains nothing is none of them.

    Parameters
    ----------
    best : Candidate
    candidates : sequence of Candidate
        Tried in its stead.
    base : float
        The sum of squares without it.
    worth : float
        By how much it lowers that.
    told : (n_trial,)
    """
    most = reach(best, worth, told)
    return [
        one
        for one in candidates
        if one is not best
        and one.hypothesis.n_number <= best.hypothesis.n_number
        and float(one.squares.sum()) <= most
        and float(one.squares.sum()) < base
    ]


def more_to_find(base: Candidate, accepted: Candidate, told: Floats) -> bool:
    """Say whether what is left could hide a cause that is worth naming."""
    left = float(accepted.squares.sum())
    least = WORTH_OF_NOISE * told.sum()
    if not accepted.model.hypotheses:
        least = max(least, WORTH_OF_ALL * (base.squares.sum() - min(told.sum(), left)))
    return bool(left - _SURELY_NOISE * told.sum() > least)


def worth_it(regression: Regression, base: Candidate, accepted: Candidate, best: Candidate, told: Floats) -> bool:
    """Say whether a candidate explains enough beside what was accepted."""
    gain = accepted.squares - best.squares
    event, beside = best.hypothesis.kind.name in EVENTS, accepted.model.hypotheses
    if gain.sum() < max(WORTH_AT_LEAST, _least(base, accepted, best, told)):
        return False
    if beside and event and not _settles(best, gain, told):
        # It was found in coarse steps, and the psi of what was accepted made up for it as far as they could.
        anew = fitted(regression, with_free_times(best.model))
        if not _settles(anew, accepted.squares - anew.squares, told):
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


def _least(base: Candidate, accepted: Candidate, best: Candidate, told: Floats) -> float:
    """Return how much a candidate must explain beside what was accepted."""
    event, numbers = best.hypothesis.kind.name in EVENTS, float(told.sum())
    beyond = float(base.squares.sum()) - min(numbers, float(best.squares.sum()))
    if not accepted.model.hypotheses:
        return max((WORTH_OF_EVENTS if event else WORTH_OF_NOISE) * numbers, WORTH_OF_ALL * beyond)
    left = float(accepted.squares.sum()) - numbers
    least = max((WORTH_OF_NEXT_EVENT if event else WORTH_OF_NEXT) * numbers, WORTH_OF_LEFT * left)
    play = any(hypothesis.kind.name == "backlash" for hypothesis in accepted.model.hypotheses)
    return max(least, WORTH_BESIDE_PLAY * beyond) if play else least
