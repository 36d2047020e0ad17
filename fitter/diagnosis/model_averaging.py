"""Standard errors that hold whichever of several equally likely causes is the true one.

A number depends on the model. Where a cause has equals, and the data do not tell which is true, the numbers of
everything else are known only as well as all of these models together say: with the likelihoods' ratios w_m as the
models' probabilities, about the number x of the model that is reported (Buckland, Burnham and Augustin 1997),

    var(x) = s^2 + sum_m w_m (x_m - x)^2 .

A drive's gain at one joint is the inverse gain at the other, of an arm of another mass: friction then differs by
that factor, too.
"""

from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.search import Search
from fitter.search.fitted_parameter import FittedParameter


def averaged(search: Search, found: Estimates, rivals: dict[int, Estimates]) -> Estimates:
    """Return the numbers of the final model with errors that hold for the causes' equals, too.

    Parameters
    ----------
    search : Search
    found : Estimates
        Of its final model.
    rivals : dict from int to Estimates
        Of every cause's rivals beside all other causes, by their candidates' ids.
    """
    std, effects = found.std.copy(), [dict(one) for one in found.effects]
    for cause in search.causes:
        for rival, probability in zip(cause.beside, cause.support[1:], strict=True):
            own = rivals[id(rival)]
            std = _widened(found, std, own, probability)
            for k, other in _shared(search.final, cause.place, rival):
                for name, parameter in effects[k].items():
                    value = own.effects[other][name].value
                    effects[k][name] = _wider(parameter, value, probability)
    return replace(found, std=std, effects=tuple(effects))


def _shared(final: Candidate, place: int, rival: Candidate) -> list[tuple[int, int]]:
    """Return the places of hypotheses but one in the final model, and where they are in a rival's, if there."""
    where = {one.key: k for k, one in enumerate(rival.model.hypotheses)}
    keys = [one.key for one in final.model.hypotheses]
    return [(k, where[key]) for k, key in enumerate(keys) if k != place and key in where]


def _wider(parameter: FittedParameter, value: float, probability: float) -> FittedParameter:
    error = np.sqrt(parameter.std**2 + probability * (value - parameter.value) ** 2)
    return replace(parameter, std=float(error)) if np.isfinite(error) else parameter


def _widened(found: Estimates, std: Floats, own: Estimates, probability: float) -> Floats:
    """Return the base parameters' errors, widened by what a rival makes of those that it has, too."""
    values = dict(zip(own.base.names, own.values, strict=True))
    apart = found.values - np.array([values.get(name, np.nan) for name in found.base.names])
    wider = np.sqrt(std**2 + probability * apart**2)
    return np.where(np.isfinite(wider), wider, std)
