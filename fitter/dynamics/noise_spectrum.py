"""Each frequency of each joint in units of its noise, which is found along: restricted maximum likelihood.

With the sums of `fitter.regression_sums.spectral_sums` the likelihood of independent noise is least squares, in
which band b of joint j counts by one over its variance ``S``. That variance is the residual's power over its
degrees of freedom: coefficients less leverage, ``tr(A^-1 A_bj) / S`` (Patterson and Thompson 1971).
Low frequencies, where the parameters take up much of the noise, are so not taken to be better than they are.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.regression_sums.spectral_sums import SpectralSums
from fitter.regression_sums.torque_sums import TorqueSums

#: Parameters that are not sought, by their index.
Held: TypeAlias = Mapping[int, float]

#: A variance is taken from at least this many degrees of freedom: known to a third (chi squared), and from bands
#: at least a third of an octave wide.
_FREEDOM, _WIDER = 20.0, 2.0 ** (1.0 / 3.0)
#: Largest change of a parameter at convergence, as a fraction of its standard error.
_SETTLED, _ROUNDS = 1e-2, 30
#: Least noise as a fraction of the torque's power: rounding.
_ROUNDING = 1e-20


def weighted_by_noise(spectral: SpectralSums, prior: Floats, held: Held) -> TorqueSums:
    """Return sums in which every coefficient has the same variance, and that variance.

    Parameters
    ----------
    spectral : SpectralSums
    prior : (n_base,)
        Stays the value of a parameter that the data cannot determine.
    held : mapping from index to value
        Parameters that are not sought.

    Returns
    -------
    TorqueSums
        With ``variance``; weights are normalised to one where the noise is least.

    Raises
    ------
    NotIdentifiable
        If the data determines no parameter.
    """
    sums = spectral.sums
    weighted = replace(sums, variance=1.0)
    values: Floats | None = None
    for _ in range(_ROUNDS):
        problem = torque_problem(weighted, prior, held)
        before, values = values, problem.complete(problem.optimum())
        if before is not None:
            std = problem.standard_errors(values)[problem.free]
            if np.all(np.abs(values - before)[problem.free] <= _SETTLED * std):
                break
        variance = _variance(spectral, _residual(sums, values), sums.count - _leverage(weighted, problem))
        least = float(variance.min())
        weighted = _scaled(sums, least / variance, least)
    return weighted


def noise_freedom(spectral: SpectralSums, weighted: TorqueSums, prior: Floats, held: Held) -> float:
    """Return the degrees of freedom from which the noise of the joint that has fewest is known.

    Parameters
    ----------
    spectral : SpectralSums
    weighted : TorqueSums
        From `weighted_by_noise`.
    prior : (n_base,)
    held : mapping from index to value
    """
    count = spectral.sums.count
    spare = (count - _leverage(weighted, torque_problem(weighted, prior, held))).sum(axis=0)
    return float(np.min(spare[count.sum(axis=0) > 0.0], initial=np.inf))


def _residual(sums: TorqueSums, values: Floats) -> Floats:
    """Return the residual's power in each band, (n_band, n_joint)."""
    explained = np.einsum("bja,a->bj", 2.0 * sums.moment - sums.gram @ values, values)
    return np.asarray(np.maximum(sums.power - explained, _ROUNDING * sums.power), dtype=np.float64)


def _leverage(weighted: TorqueSums, problem: TorqueProblem) -> Floats:
    """Return how many degrees of freedom the answer takes from each band, (n_band, n_joint)."""
    part = weighted.gram[:, :, problem.free[:, None], problem.free]
    return np.asarray(np.einsum("bjac,ac->bj", part, problem.inverse), dtype=np.float64)


def _variance(spectral: SpectralSums, power: Floats, freedom: Floats) -> Floats:
    """Return the noise of each joint in each band, from neighbouring bands together, (n_band, n_joint)."""
    variance = np.empty_like(power)
    for j in range(power.shape[1]):
        for bands in _together(spectral.frequency_hz, freedom[:, j]):
            variance[bands, j] = power[bands, j].sum() / max(freedom[bands, j].sum(), 1.0)
    floor = _ROUNDING * max(float(spectral.sums.power.sum()), 1e-300)
    return np.maximum(variance, floor)


def _together(frequency_hz: Floats, freedom: NDArray[np.float64]) -> list[slice]:
    """Part bands into runs that have enough degrees of freedom between them."""
    runs: list[slice] = []
    first, n = 0, len(frequency_hz)
    while first < n:
        last, sum_ = first, 0.0
        while last < n and (sum_ < _FREEDOM or frequency_hz[last] < _WIDER * frequency_hz[first]):
            sum_ += float(freedom[last])
            last += 1
        if sum_ < _FREEDOM and runs:
            runs[-1] = slice(runs[-1].start, last)
        else:
            runs.append(slice(first, last))
        first = last
    return runs


def _scaled(sums: TorqueSums, weight: Floats, variance: float) -> TorqueSums:
    return replace(
        sums,
        gram=sums.gram * weight[..., None, None],
        moment=sums.moment * weight[..., None],
        power=sums.power * weight,
        variance=variance,
    )
