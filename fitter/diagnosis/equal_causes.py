"""Which other causes explain as much as one of those found, all the others beside it.

What was as likely when a cause was accepted knew nothing of the causes that were found later. Beside these its
numbers are others, and it may be as likely no more. Of those that are, the likeliest is named.
"""

from dataclasses import replace

from fitter.diagnosis.evidence import Fit, is_better, penalised_log_likelihood
from fitter.diagnosis.stepwise import Found, Likelihood


def with_equals(likelihood: Likelihood, found: Found) -> Found:
    """Return what was found, every cause with those of its equals that are as likely beside all other causes.

    Parameters
    ----------
    likelihood : Likelihood
        Under the weights of the final model.
    found : Found
    """
    for step in found.steps:
        found = _with_likeliest(likelihood, found, found.steps.index(step))
    steps = []
    for place, step in enumerate(found.steps):
        pairs = _equals(likelihood, found, place)
        equals, beside = tuple(one for one, _ in pairs), tuple(other for _, other in pairs)
        steps.append(replace(step, equals=equals, beside=beside))
    return replace(found, steps=tuple(steps))


def _equals(likelihood: Likelihood, found: Found, place: int) -> list[tuple[Fit, Fit]]:
    """Return the equals of a cause as they were when it was accepted, and beside all other causes."""
    tried = [(one, likelihood.instead(found.final, place, one)) for one in found.steps[place].equals]
    return [(one, beside) for one, beside in tried if beside is not None and not is_better(found.final, beside)]


def _with_likeliest(likelihood: Likelihood, found: Found, place: int) -> Found:
    """Return what was found with the likeliest of a cause and its equals, of those with no more numbers."""
    step = found.steps[place]
    no_larger = [both for both in _equals(likelihood, found, place) if both[1].n_number <= found.final.n_number]
    now = (step.fit, found.final)
    first = max([now, *no_larger], key=lambda both: penalised_log_likelihood(both[1]))
    if first is now:
        return found
    others = tuple(one for one in step.equals if one is not first[0])
    named = replace(step, hypothesis=first[1].candidate.hypothesis, fit=first[0], equals=(step.fit, *others))
    steps = (*found.steps[:place], *found.steps[place + 1 :], named)
    return replace(found, final=first[1], steps=steps)
