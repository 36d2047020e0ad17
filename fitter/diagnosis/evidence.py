r"""Worth and equality: what a comparison of two fitted models says, the same for every likelihood.

A hypothesis of k numbers, sought at m places, is worth

.. math:: (l_1 - l_0) / \varphi - \tfrac{k}{2} \log n_{blocks} - \log m - \log n_{families}

nats: Schwarz' criterion over blocks of about a second, the places and families that were tried as a uniform prior.
Residuals of neighbouring blocks resemble each other where a model lacks something, so the gain counts divided by
its dispersion :math:`\varphi`: the variance of the blocks' gains in units of what independent ones would have.
Two models are equal if the sum of their blocks' differences is within two of its standard errors (Vuong 1989).
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats

#: Odds of a false cause, a hundred to one after Bonferroni over what was tried, are log(100) nats.
ODDS_NATS = float(np.log(100.0))
#: Standard errors within which a difference is none: 95 % of a normal distribution.
EQUAL_SIGMAS = 1.96


class Fitted(Protocol):
    """What the search has to know of a fitted model."""

    @property
    def nats(self) -> Floats:
        """Log-likelihood of blocks of all trials, (n_block,)."""

    @property
    def trial(self) -> NDArray[np.intp]:
        """The trial that each block is of, (n_block,)."""

    @property
    def learnt(self) -> NDArray[np.bool_]:
        """Whether a block is of a trial that may be learnt from, (n_block,)."""

    @property
    def n_number(self) -> int:
        """How many numbers its effects have."""


def dispersion(gain: Floats, trial: NDArray[np.intp]) -> float:
    """Return the variance of a sum of blocks' gains in units of that of independent blocks, at least 1.

    Neighbouring blocks of a trial may resemble each other: Newey and West (1987) with one lag, for blocks last a
    second and what a model lacks is correlated for less.
    """
    off = gain - gain.mean()
    own = float(off @ off)
    together = trial[1:] == trial[:-1]
    neighbours = float(np.sum((off[1:] * off[:-1])[together]))
    return max(1.0, (own + neighbours) / own) if own > 0.0 else 1.0


def standard_error(gain: Floats, trial: NDArray[np.intp]) -> float:
    """Return the standard error of the sum of blocks' gains [nats]."""
    n = len(gain)
    return float(np.sqrt(n / max(n - 1, 1) * np.sum((gain - gain.mean()) ** 2) * dispersion(gain, trial)))


def worth(one: Fitted, other: Fitted, places: int, families: int) -> float:
    """Return what a model is worth beside a smaller one [nats], see the module."""
    gain = one.nats - other.nats
    numbers = one.n_number - other.n_number
    penalty = 0.5 * numbers * np.log(len(gain)) + np.log(places) + np.log(families)
    return float(gain.sum() / dispersion(gain, one.trial) - penalty)


def is_better(one: Fitted, other: Fitted, where_learnt: bool = False) -> bool:
    """Say whether a model is better than another, beyond its numbers and what blocks' scatter explains.

    Parameters
    ----------
    one, other : Fitted
    where_learnt : bool
        Whether only those trials count that may be learnt from.
    """
    mine, theirs, trial = one.nats, other.nats, one.trial
    if where_learnt:
        mine, theirs, trial = mine[one.learnt], theirs[other.learnt], trial[one.learnt]
    gain = mine - theirs
    numbers = 0.5 * (one.n_number - other.n_number) * np.log(len(gain))
    return bool(gain.sum() - numbers > EQUAL_SIGMAS * standard_error(gain, trial))
