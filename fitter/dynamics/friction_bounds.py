"""One value between bounds that are themselves uncertain, and how well it is known.

Every stand of a joint says that its static friction F is at least, or at most, some load that is known with an
error of its own. The largest of many lower bounds is the luckiest one, and alike the smallest upper bound: an
interval between these two is too narrow and too sure. The likelihood of all bounds together, a product of normal
distribution functions, has no such choice in it. Its mean is F; its variance, and how the mean follows errors that
all bounds share, those of the base parameters, are F's error.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr

from arm.model import Floats

#: Half-width of a normal distribution function's edge [standard errors], beyond which it is 0 or 1 to rounding.
_EDGE = 8.0
#: Points over an edge and between bounds.
_POINTS = 129
#: Least noise as a fraction of a bound: rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Bound:
    """A bound of a joint's static friction, from one stand.

    Attributes
    ----------
    value, noise : float
        The bound, and the standard error that the load's noise gives it [N m or N].
    slope : (n_base,)
        How it changes with the base parameters.
    """

    value: float
    noise: float
    slope: Floats

    def error(self, covariance: Floats) -> float:
        """Return its standard error with what the base parameters are not known to."""
        return float(np.sqrt(self.noise**2 + max(float(self.slope @ covariance @ self.slope), 0.0)))


def between(lower: Sequence[Bound], upper: Sequence[Bound], covariance: Floats) -> tuple[float, float]:
    """Return the mean of a value between bounds and its standard error.

    Parameters
    ----------
    lower, upper : sequence of Bound
        At least one of each.
    covariance : (n_base, n_base)
        Of the base parameters, whose errors are common to all bounds.
    """
    bounds = [*lower, *upper]
    way = np.array([1.0] * len(lower) + [-1.0] * len(upper))
    value = np.array([bound.value for bound in bounds])
    noise = np.array([bound.noise for bound in bounds])
    noise = np.maximum(noise, _ROUNDING * np.abs(value).max())
    least, most = np.max((value - _EDGE * noise)[way > 0.0]), np.min((value + _EDGE * noise)[way < 0.0])
    least, most = min(least, most), max(least, most)
    near = (value + _EDGE * noise >= least) & (value - _EDGE * noise <= most)
    edge = np.linspace(-_EDGE, _EDGE, _POINTS)
    grid = np.concatenate([np.linspace(least, most, _POINTS), *(value[near, None] + noise[near, None] * edge)])
    grid = np.unique(np.maximum(grid, 0.0))
    apart = way[:, None] * (grid - value[:, None]) / noise[:, None]
    each = log_ndtr(apart)
    log = each.sum(axis=0)
    weight = np.exp(log - log.max()) * np.gradient(grid)
    weight /= weight.sum()
    mean = float(weight @ grid)
    # d(mean)/d(bound) = -cov(F, d log L/dF): with the likelihood's slope by each bound
    slope = way[:, None] * np.exp(-0.5 * apart**2 - each) / (np.sqrt(2.0 * np.pi) * noise[:, None])
    follows = -slope @ (weight * (grid - mean))
    common = follows @ np.array([bound.slope for bound in bounds])
    variance = float(weight @ (grid - mean) ** 2) + max(float(common @ covariance @ common), 0.0)
    return mean, float(np.sqrt(variance))


def contradict(lower: Sequence[Bound], upper: Sequence[Bound], covariance: Floats, errors: float) -> bool:
    """Say whether a lower bound exceeds an upper one by more than this many standard errors of the difference."""
    for low in lower:
        for high in upper:
            noise = float(np.hypot(low.noise, high.noise))
            apart = Bound(low.value - high.value, noise, low.slope - high.slope)
            if apart.value > 0.0 and apart.value > errors * apart.error(covariance):
                return True
    return False
