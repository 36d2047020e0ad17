"""What follows from a search: a verdict, the model that holds, its numbers, what it leaves, what rests tell."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from fitter.diagnosis.bodies import has_bodies
from fitter.diagnosis.cancellation import is_cancelled
from fitter.diagnosis.estimates import Estimates, estimates
from fitter.diagnosis.falling_friction import with_humps
from fitter.diagnosis.finding import Verdict
from fitter.diagnosis.holding import Holding, holdings
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate, fitted
from fitter.diagnosis.search import Search
from fitter.diagnosis.settled import settled
from fitter.diagnosis.unknown import Remainder, describe
from fitter.diagnosis.untold import without_untold
from fitter.diagnosis.verdict import verdict_of


@dataclass(frozen=True)
class Conclusion:
    """What a search has come to.

    Attributes
    ----------
    search : Search
        Without causes that have no size, with those that rests have told.
    verdict : {"named", "ambiguous", "none", "unexplained"}
    final : Candidate
        The search's final model, or its base where that explains too little.
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


def concluded(regression: Regression, search: Search, strict: bool) -> Conclusion:
    """Return what follows from a search.

    Parameters
    ----------
    regression : Regression
    search : Search
    strict : bool
        Whether causes are named only if next to nothing is left that they don't explain.
    """
    final, numbers = settled(regression, search.final)
    search = replace(search, final=final)
    told = without_untold(regression, search, numbers) if strict else search
    if told is not search:
        search, numbers = told, estimates(regression, told.final)
    remainder = describe(regression, search.final)
    held = holdings(regression, search.final, numbers.covariance)
    verdict = verdict_of(search, remainder, numbers, bool(held), strict)
    if verdict == "unexplained" and search.causes:
        # Learning trials may have told their sizes only roughly. A function is fitted to trials of both kinds, so
        # whether the causes are of the right form is asked of the model that is.
        form = replace(search, final=fitted(regression, search.final.model, to_all=True))
        verdict = verdict_of(form, describe(regression, form.final), numbers, bool(held), strict)
    if strict and (is_cancelled(regression, search.final) or not has_bodies(regression, search.final)):
        verdict = "unexplained"
    if verdict == "none" and search.causes:  # they have no size
        search = replace(search, final=search.base, causes=[])
        numbers, remainder = estimates(regression, search.base), describe(regression, search.base)
        held = holdings(regression, search.base, numbers.covariance)
        verdict = "named" if held else "none"
    if verdict == "unexplained":
        left = describe(regression, search.base) if search.causes else remainder
        return Conclusion(search, verdict, search.base, numbers, left, held, {})
    found, held, equals = with_humps(regression, search, held)
    if found is not search:
        numbers, remainder = estimates(regression, found.final), describe(regression, found.final)
    return Conclusion(found, "ambiguous" if equals else verdict, found.final, numbers, remainder, held, equals)
