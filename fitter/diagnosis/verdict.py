"""What is said of it all: named, ambiguous, none, or unexplained."""

from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.finding import Verdict
from fitter.diagnosis.hypotheses import EVENTS
from fitter.diagnosis.search import UNEXPLAINED, UNEXPLAINED_AT_LEAST, Search
from fitter.diagnosis.unknown import WORTH, Remainder
from fitter.diagnosis.untold import are_told

#: If a smooth function explains more than this share of what the base model leaves, beside the causes, then these
#: are not it. True causes left less than a five-hundredth in every case that was looked at.
_UNEXPLAINED = 0.03
#: … or this share, where the function tells so much of what trials are typically left with: that is no noise.
_PLAINLY, _UNEXPLAINED_PLAINLY = 1.0 / 3.0, 0.005
#: … nor if they leave more than `UNEXPLAINED` of it in any form, or this beside a play, for how its motor crosses
#: it nobody can see; true causes left less in every case that was looked at.
_LEFT_BY_PLAY = 0.5
#: Where a base model leaves so many times the noise beyond it, something is there even if nothing explains it.
_STRUCTURE = 2.0
#: A cause that explains this share of the number of equations is there, even if its numbers, which may make up for
#: one another, are not told one by one; where nothing is hidden none explains a hundredth of it (`worth`). Beside
#: other causes it must be the second share, and one of them must be told: a formula that is not quite right leaves
#: something, too, and two may be no more than the two halves of one that is not known. An event can be found for
#: anything.
_SURELY, _SURELY_BESIDE = 0.2, 3.0


def verdict_of(search: Search, remainder: Remainder, numbers: Estimates, held: bool, strict: bool) -> Verdict:
    """Return the verdict.

    Parameters
    ----------
    search : Search
    remainder : Remainder
        What its final model leaves, described.
    numbers : Estimates
        Of that model.
    held : bool
        Whether a joint that rests is held by more than its friction: that is a cause of its own.
    strict : bool
        Whether causes are named only if next to nothing is left that they don't explain.
    """
    noise = float(search.told.sum())
    beyond = float(search.base.squares.sum()) - search.noise
    left = remainder.worth * noise
    names = {hypothesis.kind.name for hypothesis in search.final.model.hypotheses}
    if not search.causes:
        if remainder.worth > WORTH or search.structure > _STRUCTURE:
            return "unexplained"
        return "named" if held else "none"
    played = "backlash" in names
    share = _UNEXPLAINED_PLAINLY if remainder.explained > _PLAINLY else _UNEXPLAINED
    smooth = remainder.worth > WORTH and left > (_LEFT_BY_PLAY if played else share) * beyond
    too_much = search.leaves(_LEFT_BY_PLAY if played else UNEXPLAINED, UNEXPLAINED_AT_LEAST)
    if strict and (search.outdone or smooth or too_much):
        return "unexplained"
    if strict and not all(_is_there(search, numbers)):
        return "unexplained" if len(search.causes) > 1 or search.structure > _STRUCTURE else "none"
    return "ambiguous" if any(cause.rivals for cause in search.causes) else "named"


def _is_there(search: Search, numbers: Estimates) -> list[bool]:
    """Say of every cause whether it has a size, or explains so much that it must be there without one."""
    surely = (_SURELY if len(search.causes) == 1 else _SURELY_BESIDE) * float(search.told.sum())
    told = are_told(search.final.model, numbers)
    kinds = [hypothesis.kind.name for hypothesis in search.final.model.hypotheses]
    some = any(told) or len(search.causes) == 1
    return [
        told[cause.place] or (some and cause.worth > surely and kinds[cause.place] not in EVENTS)
        for cause in search.causes
    ]
