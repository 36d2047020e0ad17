"""Stationary processes of a state: a joint's speed, and accelerations that are forgotten.

A speed is a Matern process of smoothness 3/2, ``dddq = -2 r ddq - r^2 dq + push``, of variance
``push^2 / (4 r^3)`` (C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, 2006, app. B).
With the rate 0 it is the integral of an acceleration that wanders. An acceleration that is forgotten is an
Ornstein-Uhlenbeck process.
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Below this product of rate and step the process is its limit, the integral: to the rounding of a state.
_NO_RATE = 1e-6


@compiled
def transition(rate: float, dt: float) -> tuple[float, float, float, float, float, float]:
    """Return how q, dq, ddq follow from dq and ddq a step before: q by both, dq by both, ddq by both.

    Parameters
    ----------
    rate : float [1/s]
    dt : float [s]

    Returns
    -------
    tuple of float
        dq to q, ddq to q, dq to dq, ddq to dq, dq to ddq, ddq to ddq.
    """
    if rate * dt < _NO_RATE:
        return dt, 0.5 * dt * dt, 1.0, dt, 0.0, 1.0
    s = rate * dt
    kept = np.exp(-s)
    return (
        (2.0 - kept * (2.0 + s)) / rate,
        (1.0 - kept * (1.0 + s)) / rate**2,
        kept * (1.0 + s),
        kept * dt,
        -kept * rate * s,
        kept * (1.0 - s),
    )


@compiled
def decay(x: Floats, P: Floats, at: int, kept: float, std: float) -> None:
    """Carry the Ornstein-Uhlenbeck process in entry ``at`` on by a step, of which the share ``kept`` remains."""
    size = x.size
    x[at] *= kept
    for c in range(size):
        P[at, c] *= kept
    for c in range(size):
        P[c, at] *= kept
    P[at, at] += std * std * (1.0 - kept * kept)
