"""The likelihood ratio of a column in Student's noise, with the column's likeliest size."""

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import ITERATIONS, SETTLED, TINY
from limbcal.compiled import compiled


@compiled
def log_ratio(e: Floats, other: Floats, nu: float) -> float:
    """Return by how much Student's log density of some innovations is more than that of others."""
    return log_loss(other, other, 0.0, nu) - log_loss(e, e, 0.0, nu)


@compiled
def log_loss(e: Floats, s: Floats, c: float, nu: float) -> float:
    """Return minus Student's log density of ``e - c s``, less that of zeros."""
    loss = 0.0
    for i in range(len(e)):
        remaining = e[i] - c * s[i]
        loss += np.log1p(remaining * remaining / nu)
    return 0.5 * (nu + 1.0) * loss


@compiled
def likeliest_size(e: Floats, s: Floats, nu: float) -> tuple[float, float]:
    """Return the size c of ``e = c s + Student's noise``, and the information on it, by reweighting.

    Parameters
    ----------
    e, s : (n,)
        Standardised innovations of a residual and of a column.
    nu : float
        Degrees of freedom.
    """
    c, square = 0.0, 0.0
    for step in range(ITERATIONS):
        before, product, square = c, 0.0, TINY
        for i in range(len(e)):
            miss = e[i] - c * s[i]
            weight = 1.0 if step == 0 else (nu + 1.0) / (nu + miss * miss)
            product += weight * e[i] * s[i]
            square += weight * s[i] * s[i]
        c = product / square
        if step > 0 and abs(c - before) < SETTLED * abs(c):
            break
    return c, square


@compiled
def likeliest_ratio(e: Floats, s: Floats, nu: float) -> tuple[float, float]:
    """Return the log likelihood ratio of ``e = c s + Student's noise`` against c = 0, and c."""
    c, _ = likeliest_size(e, s, nu)
    return log_loss(e, s, 0.0, nu) - log_loss(e, s, c, nu), c
