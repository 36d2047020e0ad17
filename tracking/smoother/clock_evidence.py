"""Which sensors' clocks differ: those of which the readings say so twice, whatever else of the sensors does.

A lateness explains much of what an arm lacks besides, such as flesh that gives way. So a sensor's clock is let go
only if readings with it are a hundred times likelier than without (the Bayes factor), and if it also predicts:
what the other blocks of the recording say of it makes the readings of each block likelier, by as much in all
(cross-validation; M. Stone, *Cross-validatory choice and assessment of statistical predictions*, 1974). A sensor
that is loose reads much like one that is late, and both are judged alike, each beside all others that are kept
(`tracking.smoother.sensor_effects`). A pass each is enough: along the most probable motion the log-likelihood is
quadratic in the sizes of such effects. Readings count as many times less as their errors are more dispersed than
the model has it (quasi-likelihood; P. McCullagh, J. A. Nelder, *Generalized Linear Models*, 1989, ch. 9).
"""

from typing import NamedTuple

import numpy as np

from arm.model import Floats

#: What either must exceed [nats]: a hundred to one.
_LEAST_NATS = float(np.log(100.0))


class EffectSlopes(NamedTuple):
    """What blocks of a recording say of sizes of effects: slopes and curvatures of the log-likelihood at zero.

    Attributes
    ----------
    gradient : (n_block, n_effect)
    information : (n_block, n_effect, n_effect)
    prior_std : (n_effect,)
        Of each size.
    """

    gradient: Floats
    information: Floats
    prior_std: Floats


def effect_slopes(
    error: Floats,
    precision: Floats,
    slopes: Floats,
    information: Floats,
    prior_std: Floats,
    length: int,
    dispersion: float = 1.0,
) -> EffectSlopes:
    """Return what blocks say of sizes of effects.

    Parameters
    ----------
    error, precision : (n, n_channel)
        Smoothing errors of the readings, all sizes being held to be zero, and their variances
        (`tracking.smoother.smoothing_pass.Pass`); zero where nothing was read.
    slopes : (n_effect, n, n_channel)
        Of the readings by these sizes.
    information : (n_effect, n_effect)
        What all readings say of them. Each block has its share in it.
    prior_std : (n_effect,)
    length : int
        Instants of a block.
    dispersion : float
        By how many times the readings' errors vary more than the model has it.
    """
    # the last block is no shorter than half of one
    begins = np.arange(0, max(1, len(error) - length // 2), length)
    gradient = np.add.reduceat(np.einsum("akc,kc->ka", slopes, error), begins, axis=0)
    squares = np.add.reduceat(np.einsum("akc,kc->ka", slopes**2, precision), begins, axis=0)
    share = np.sqrt(squares / np.maximum(squares.sum(axis=0), np.finfo(np.float64).tiny))
    each = share[:, :, None] * information * share[:, None, :]
    return EffectSlopes(gradient / dispersion, each / dispersion, prior_std)


def accepted(slopes: EffectSlopes) -> list[int]:
    """Return the effects that are there: those that too little speaks for are left out, the least one first."""
    kept = list(range(slopes.gradient.shape[1]))
    while kept:
        whole = _evidence(slopes, kept)
        gains = [min(np.subtract(whole, _evidence(slopes, [c for c in kept if c != one]))) for one in kept]
        if min(gains) > _LEAST_NATS:
            break
        kept.pop(int(np.argmin(gains)))
    return kept


def _evidence(slopes: EffectSlopes, kept: list[int]) -> tuple[float, float]:
    """Return the logarithms of the Bayes factor of some effects against none, and of what they predict [nats]."""
    if not kept:
        return 0.0, 0.0
    at, unit = np.array(kept), slopes.prior_std[kept]
    gradient, information = slopes.gradient[:, at] * unit, slopes.information[:, at[:, None], at]
    information = information * np.outer(unit, unit)
    total, precise = gradient.sum(axis=0), information.sum(axis=0) + np.eye(len(at))
    factor = 0.5 * total @ np.linalg.solve(precise, total) - 0.5 * np.linalg.slogdet(precise)[1]
    predicted = 0.0
    for own, known in zip(gradient, information, strict=True):
        found = np.linalg.solve(precise - known, total - own)
        predicted += own @ found - 0.5 * found @ known @ found
    return float(factor), float(predicted)
