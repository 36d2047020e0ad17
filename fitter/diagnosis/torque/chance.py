r"""How evident pulses are by chance: the tail of the evidence, from the residual itself.

No background is exact. Where one follows its model, evidence of at least E for a pulse comes by chance with a
probability below exp(-E). Where it does not, as where an effect is modelled roughly and its errors come in bursts,
evidence has a longer tail; so that tail is learnt from what no pulse is taken for (an empirical null: Efron 2004).
Of the evidence within blocks, the excesses over the median are exponential,

.. math:: P(E > u + y) = \tfrac{1}{2} e^{-y / \beta}                                                      (m.3)

as those of light tails are (Balkema and de Haan 1974).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from arm.model import Floats
from fitter.diagnosis.least_squares import NEGLIGIBLE, ROUNDED

#: Scale of the tail of a background that follows its model, by Markov's inequality [nats].
_LEAST_SCALE = 1.0


@dataclass(frozen=True)
class Tail:
    """The tail of the evidence of blocks without a pulse.

    Attributes
    ----------
    threshold, scale : float [nats]
        The median u, and beta.
    """

    threshold: float
    scale: float

    @classmethod
    def of(cls, evidence: Floats, most: float) -> "Tail":
        """Return the tail by maximum likelihood.

        Parameters
        ----------
        evidence : (n_block,) [nats]
            Of blocks without a pulse.
        most : float [nats]
            Blocks of more evidence are taken for pulses: the excesses' distribution is cut off there.
        """
        if len(evidence) == 0:
            return cls(0.0, _LEAST_SCALE)
        threshold = float(np.median(evidence))
        excess = evidence[evidence > threshold] - threshold
        if len(excess) == 0:
            return cls(threshold, _LEAST_SCALE)
        return cls(threshold, max(_LEAST_SCALE, _scale(float(excess.mean()), most - threshold)))

    def nats(self, evidence: float) -> float:
        """Return minus the logarithm of the probability of so evident a block by chance, eq. (m.3)."""
        return float(np.log(2.0) + max(evidence - self.threshold, 0.0) / self.scale)


def _scale(mean: float, most: float) -> float:
    """Return the scale of an exponential distribution that is cut off, by its mean there."""
    if most <= 0.0 or mean >= 0.5 * most:  # as frequent up there as below
        return max(most, mean) / NEGLIGIBLE

    def missing(scale: float) -> float:
        return scale - most / float(np.expm1(most / scale)) - mean

    uncut = mean
    if most > -np.log(ROUNDED) * mean:  # so far out a cut is rounding
        return uncut
    longest = most / NEGLIGIBLE  # as good as flat
    return float(brentq(missing, uncut, longest)) if missing(longest) > 0.0 else longest
