"""Which sensors' clocks differ: those of which the readings say so twice.

A lateness explains much of what an arm lacks besides, such as flesh that gives way. So a sensor's clock is let go
only if readings with it are a hundred times likelier than without (the Bayes factor), and if it also predicts:
what the other blocks of the recording say of it makes the readings of each block likelier, by as much in all
(cross-validation; M. Stone, *Cross-validatory choice and assessment of statistical predictions*, 1974). Both come
of one pass: along the most probable motion the log-likelihood is quadratic in the latenesses. Readings count as
many times less as their errors are more dispersed than the model has it (quasi-likelihood; P. McCullagh, J. A.
Nelder, *Generalized Linear Models*, 1989, ch. 9).
"""

from typing import NamedTuple

import numpy as np

from arm.model import Floats

#: What either must exceed [nats]: a hundred to one.
_LEAST_NATS = float(np.log(100.0))


class ClockSlopes(NamedTuple):
    """What blocks of a recording say of latenesses, all being zero: slopes and curvatures of the log-likelihood.

    Attributes
    ----------
    gradient : (n_block, n_clock) [1/s]
    information : (n_block, n_clock, n_clock) [1/s^2]
    prior_std_s : float
        Of each lateness.
    """

    gradient: Floats
    information: Floats
    prior_std_s: float


def clock_slopes(
    error: Floats,
    precision: Floats,
    drift: Floats,
    covariance: Floats,
    prior_std_s: float,
    length: int,
    dispersion: float = 1.0,
) -> ClockSlopes:
    """Return what blocks say of latenesses.

    Parameters
    ----------
    error, precision : (n, n_clock, n_of_clock)
        Smoothing errors of the readings that share a clock, all clocks being held to agree, and their variances
        (`tracking.smoother.smoothing_pass.Pass`); zero where nothing was read.
    drift : (n, n_clock, n_of_clock)
        Rates of these readings.
    covariance : (n_clock, n_clock) [s^2]
        Of the latenesses after all readings, if they are let go.
    prior_std_s : float
    length : int
        Instants of a block.
    dispersion : float
        By how many times the readings' errors vary more than the model has it.
    """
    # the last block is no shorter than half of one
    begins = np.arange(0, max(1, len(error) - length // 2), length)
    gradient = np.add.reduceat(-(error * drift).sum(axis=2), begins, axis=0)
    squares = np.add.reduceat((precision * drift**2).sum(axis=2), begins, axis=0)
    share = np.sqrt(squares / np.maximum(squares.sum(axis=0), np.finfo(np.float64).tiny))
    whole = np.linalg.inv(covariance) - np.eye(len(covariance)) / prior_std_s**2
    information = share[:, :, None] * whole * share[:, None, :]
    return ClockSlopes(gradient / dispersion, information / dispersion, prior_std_s)


def accepted(slopes: ClockSlopes) -> list[int]:
    """Return the clocks that differ: all but those that too little speaks for, the least one left out first."""
    kept = list(range(slopes.gradient.shape[1]))
    while kept:
        whole = _evidence(slopes, kept)
        gains = [min(np.subtract(whole, _evidence(slopes, [c for c in kept if c != clock]))) for clock in kept]
        if min(gains) > _LEAST_NATS:
            break
        kept.pop(int(np.argmin(gains)))
    return kept


def _evidence(slopes: ClockSlopes, kept: list[int]) -> tuple[float, float]:
    """Return the logarithms of the Bayes factor of some clocks against none, and of what they predict [nats]."""
    if not kept:
        return 0.0, 0.0
    at = np.array(kept)
    gradient, information = slopes.gradient[:, at], slopes.information[:, at[:, None], at]
    prior = np.eye(len(at)) / slopes.prior_std_s**2
    total, precise = gradient.sum(axis=0), information.sum(axis=0) + prior
    factor = 0.5 * total @ np.linalg.solve(precise, total)
    factor -= 0.5 * np.linalg.slogdet(precise / prior[0, 0])[1]
    predicted = 0.0
    for own, known in zip(gradient, information, strict=True):
        late = np.linalg.solve(precise - known, total - own)
        predicted += own @ late - 0.5 * late @ known @ late
    return float(factor), float(predicted)
