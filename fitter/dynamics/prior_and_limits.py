"""Where the parameters of a search may be, and what was known of them beforehand."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from arm.model import Floats


def _unlimited(x: Floats) -> tuple[Floats, Floats]:
    return np.zeros(0), np.zeros((0, len(x)))


@dataclass(frozen=True)
class Allowed:
    """Where the parameters may be, and what was known of them beforehand.

    Attributes
    ----------
    low, high : (n_free,) or float
    limits : callable
        Returns g (m,) and its slopes (m, n_free) at x: allowed is where no g is negative. In units in which one is
        large.
    prior_std : (n_free,) or float
        Standard errors of ``x0``; infinite where nothing was known.
    """

    low: Floats | float = -np.inf
    high: Floats | float = np.inf
    limits: Callable[[Floats], tuple[Floats, Floats]] = _unlimited
    prior_std: Floats | float = np.inf

    def inequalities(self, x: Floats, scale: Floats, inside: float = 0.0) -> tuple[Floats, Floats]:
        """Return g and its slopes at x, bounds included: ``g + G dx >= 0``.

        Parameters
        ----------
        x, scale : (n_free,)
            Bounds are in units of the scale.
        inside : float
            How far within the limits to stay.
        """
        g, G = self.limits(x)
        low, high = (np.broadcast_to(one, x.shape) for one in (self.low, self.high))
        unit = np.diag(1.0 / scale)
        g = np.concatenate([g - inside, (x - low) / scale, (high - x) / scale])
        G = np.vstack([G, unit, -unit])
        finite = np.isfinite(g)
        return g[finite], G[finite]

    def admits(self, x: Floats) -> bool:
        """Say whether x is within the limits."""
        return bool(np.all(self.limits(x)[0] >= 0.0))

    def prior(self, x: Floats, x0: Floats) -> Floats:
        """Return how far x is from what was known, in its standard errors, (n_free,)."""
        return np.asarray((x0 - x) / self.prior_std, dtype=np.float64)
