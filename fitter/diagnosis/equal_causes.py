"""Which other causes explain as much as one of those found, all the others beside it.

What was as likely when a cause was accepted knew nothing of the causes that were found later. Beside these its
numbers are others, and it may be as likely no more.
"""

from dataclasses import replace

from fitter.diagnosis.evidence import Fit, is_better
from fitter.diagnosis.stepwise import Found, Likelihood, Step


def with_equals(likelihood: Likelihood, found: Found) -> Found:
    """Return what was found, every cause with those of its equals that are as likely beside all other causes.

    Parameters
    ----------
    likelihood : Likelihood
        Under the weights of the final model.
    found : Found
    """
    steps = [_beside_others(likelihood, found.final, place, step) for place, step in enumerate(found.steps)]
    return replace(found, steps=tuple(steps))


def _beside_others(likelihood: Likelihood, final: Fit, place: int, step: Step) -> Step:
    tried = [likelihood.instead(final, place, one) for one in step.equals]
    return replace(step, equals=tuple(one for one in tried if one is not None and not is_better(final, one)))
