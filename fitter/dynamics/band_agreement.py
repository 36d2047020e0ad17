"""Whether low and high frequencies say the same of an arm: a test of the likelihood's assumptions.

The likelihood of `fitter.dynamics.noise_spectrum` holds where the residual is the torque's noise. Coefficients
of different frequencies are then independent, and two fits, one of each half of the information, differ by no
more than their standard errors. Noise in the regressors, or a torque that the model lacks, breaks this: both
have a spectrum of their own (the idea is Hausman's, Econometrica 46, 1978).
"""

from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Floats
from fitter.dynamics.noise_spectrum import Held, weighted_by_noise
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.regression_sums.spectral_sums import SpectralSums
from fitter.regression_sums.torque_sums import TorqueSums
from limbcal.errors import NotIdentifiable

#: Probability with which frequencies that do agree are taken to disagree.
FALSE_ALARM = 1e-3


def frequencies_agree(spectral: SpectralSums, weighted: TorqueSums, prior: Floats, held: Held) -> bool:
    """Say whether fits of the lower and the upper half of the information agree (F-test at `FALSE_ALARM`).

    Parameters
    ----------
    spectral : SpectralSums
    weighted : TorqueSums
        Of all bands, from `weighted_by_noise`: where their information is halved.
    prior : (n_base,)
        Stays the value of a parameter that the data cannot determine.
    held : mapping from index to value
        Parameters that are not sought.

    Returns
    -------
    bool
        True, too, where one half alone determines no parameter: nothing speaks against the likelihood then.
    """
    half = _half(weighted, torque_problem(weighted, prior, held))
    bands = np.arange(len(spectral.frequency_hz))
    try:
        fits = [_fit(_part(spectral, part), prior, held) for part in (bands <= half, bands > half)]
    except NotIdentifiable:
        return True
    (low, low_values), (high, high_values) = fits
    shared = np.flatnonzero(low.revealed & high.revealed & np.isin(np.arange(len(prior)), _both(low, high)))
    if not len(shared):
        return True
    covariance = sum(_covariance(problem, shared) for problem in (low, high))
    scale = np.sqrt(np.diag(covariance))
    difference = (low_values - high_values)[shared] / scale
    statistic = (
        difference @ np.linalg.pinv(covariance / np.outer(scale, scale), rcond=1e-8, hermitian=True) @ difference
    )
    freedom = min(problem.sums.count.sum() - len(problem.free) for problem in (low, high))
    limit = scipy.stats.f.ppf(1.0 - FALSE_ALARM, len(shared), max(float(freedom), 1.0))
    return bool(statistic / len(shared) <= limit)


def _half(weighted: TorqueSums, problem: TorqueProblem) -> int:
    """Return the last band of the lower half of the information on the free parameters."""
    grams = weighted.gram.sum(axis=1)[:, problem.free[:, None], problem.free]
    information = np.cumsum(np.einsum("bac,ac->b", grams, problem.inverse))
    return int(np.searchsorted(information, information[-1] / 2.0))


def _part(spectral: SpectralSums, bands: NDArray[np.bool_]) -> SpectralSums:
    names = ("gram", "moment", "power", "row", "torque", "count", "trial")
    sums = replace(spectral.sums, **{name: getattr(spectral.sums, name)[bands] for name in names})
    return SpectralSums(sums, spectral.frequency_hz[bands])


def _fit(spectral: SpectralSums, prior: Floats, held: Held) -> tuple[TorqueProblem, Floats]:
    problem = torque_problem(weighted_by_noise(spectral, prior, held), prior, held)
    return problem, problem.complete(problem.optimum())


def _both(low: TorqueProblem, high: TorqueProblem) -> NDArray[np.intp]:
    return np.intersect1d(low.free, high.free)


def _covariance(problem: TorqueProblem, shared: NDArray[np.intp]) -> Floats:
    place = np.searchsorted(problem.free, shared)
    assert problem.sums.variance is not None
    return problem.sums.variance * problem.inverse[np.ix_(place, place)]
