"""What follows from a search: a verdict, the model that holds, its numbers, what it leaves, what rests tell."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fitter.diagnosis.estimates import Estimates, estimates
from fitter.diagnosis.falling_friction import with_humps
from fitter.diagnosis.holding import Holding, holdings
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.search import Search, Verdict
from fitter.diagnosis.unknown import Remainder, describe, outdone


@dataclass(frozen=True)
class Conclusion:
    """What a search has come to.

    Attributes
    ----------
    search : Search
        With the causes that rests of the joints reveal.
    verdict : {"named", "ambiguous", "none", "unexplained"}
    final : Candidate
        The search's final model, or its base where no cause is believed.
    numbers : Estimates
        Of the search's final model.
    remainder : Remainder
        What `final` leaves.
    held : sequence of Holding
        Joints that are held by static friction.
    equals : mapping of int to Candidate
        With a hump of friction that might as well hold such a joint, by its number.
    """

    search: Search
    verdict: Verdict
    final: Candidate
    numbers: Estimates
    remainder: Remainder
    held: Sequence[Holding]
    equals: Mapping[int, Candidate]


def concluded(regression: Regression, search: Search) -> Conclusion:
    """Return what follows from a search.

    Parameters
    ----------
    regression : Regression
        Under the weights of the search's final model.
    search : Search
    """
    numbers = estimates(regression, search.final)
    held = holdings(regression, search.final, numbers.covariance)
    remainder = describe(regression, search.final, search.floor)
    verdict = _verdict(regression, search, remainder, bool(held))
    if verdict == "unexplained":
        left = describe(regression, search.base, search.was) if search.causes else remainder
        return Conclusion(search, verdict, search.base, numbers, left, held, {})
    found, held, equals = with_humps(regression, search, held)
    if found is not search:
        numbers, remainder = estimates(regression, found.final), describe(regression, found.final, search.floor)
    return Conclusion(found, "ambiguous" if equals else verdict, found.final, numbers, remainder, held, equals)


def _verdict(regression: Regression, search: Search, remainder: Remainder, held: bool) -> Verdict:
    """Return the verdict.

    Causes are believed unless some unknown function of few variables, in their place, does clearly better:
    they then imitate what stands in no catalogue.
    """
    if search.final.model.hypotheses:
        if outdone(regression, search.final):
            return "unexplained"
        return "ambiguous" if any(cause.rivals for cause in search.causes) else "named"
    if (search.floor.is_plain and not remainder.white) or outdone(regression, search.base):
        return "unexplained"
    return "named" if held else "none"
