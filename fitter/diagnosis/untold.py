"""Causes that have no size go: with them the others explain no more than they do alone.

A formula that is not quite right, or noise that is not quite known, leaves something of which one of hundreds of
further causes explains a part, as large as it likes.
"""

from dataclasses import replace

import numpy as np

from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.search import UNEXPLAINED, UNEXPLAINED_AT_LEAST, Search

#: Some number of a cause must differ by so many standard errors from what it is without it.
_TOLD_SIGMAS = 3.0


def are_told(model: Model, found: Estimates) -> list[bool]:
    """Say of every cause whether it has a size.

    Parameters
    ----------
    model : Model
    found : Estimates
        Of that model.
    """
    told = []
    for hypothesis, numbers in zip(model.hypotheses, found.effects, strict=True):
        neutral = {parameter.name: parameter.neutral for parameter in hypothesis.kind.parameters}
        sizes = []
        for name, number in numbers.items():
            none = neutral.get(name, neutral.get(name.rstrip("0123456789").removesuffix("_")))
            if none is not None:
                off = abs(number.value - (none if np.isfinite(none) else 0.0))
                sizes.append(off > _TOLD_SIGMAS * number.std)
        told.append(not sizes or any(sizes))
    return told


def without_untold(regression: Regression, search: Search, found: Estimates) -> Search:
    """Return a search without the causes that have no size, where the others explain what there is.

    Parameters
    ----------
    regression : Regression
    search : Search
    found : Estimates
        Of its final model.
    """
    model = search.final.model
    told = are_told(model, found)
    if all(told) or not any(told):
        return search
    kept = [k for k, is_told in enumerate(told) if is_told]
    causes = [replace(cause, place=kept.index(cause.place)) for cause in search.causes if cause.place in kept]
    reduced = replace(search, final=fitted(regression, model.only(told)), causes=causes)
    return search if reduced.leaves(UNEXPLAINED, UNEXPLAINED_AT_LEAST) else reduced
