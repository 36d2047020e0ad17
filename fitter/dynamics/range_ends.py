r"""Tissue that stiffens towards the ends of the ranges that free swings reach (`arm.effects.passive_tissue`).

Its moment is linear in the moment M at the end that was reached, but not in its rate. So each of several rates is
tried, and at the likeliest one the first order in the rate is fitted along, so that intervals allow for what lies
between:

.. math:: M e^{\lambda x} \approx (M + M \Delta\lambda\, x)\, e^{\lambda_0 x},
    \qquad x = s (q - q_e) \le 0
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from arm.model import Arm, Floats
from fitter.data.trial import Trial
from fitter.search.fitted_parameter import FittedParameter

#: Rates [1/rad] of the softest to the stiffest end of a person's leg and trunk (Anderson 1999, table G.2: 5 to 70;
#: Riener and Edrich 1999: 1.7 to 11), half an octave apart.
RATES = np.geomspace(2.0, 64.0, 11)
#: Probability that tissue is seen at any end where there is none.
_FALSE = 0.05


@dataclass(frozen=True)
class RangeEnd:
    """The end of a joint's range that swings reach.

    Attributes
    ----------
    joint : int
        From 0.
    side : float
        1 where tissue resists forwards, -1 backwards.
    angle_rad : float
        Where its moment is stated: as far as the joint came.
    rate_1_rad : float
    """

    joint: int
    side: float
    angle_rad: float
    rate_1_rad: float


@dataclass(frozen=True)
class Fit:
    """A least-squares fit: values, their standard errors (NaN where not identified), and its cost."""

    values: Floats
    std: Floats
    cost: float

    def after(self, k: int) -> "Fit":
        """Return the fit of the parameters from the k-th on."""
        return Fit(self.values[k:], self.std[k:], self.cost)

    def parameter(self, k: int, unit: str) -> FittedParameter:
        """Return one of the parameters; one that the fit has not is not identifiable."""
        if k >= len(self.values):
            return FittedParameter(0.0, float("nan"), unit, identifiable=False)
        value, std = float(self.values[k]), float(self.std[k])
        return FittedParameter(value, std, unit, bool(np.isfinite(std)))


def end_columns(ends: Sequence[RangeEnd], q: Floats, order: int) -> Floats:
    """Return what tissue of 1 N m at each end resists with.

    Parameters
    ----------
    ends : sequence of RangeEnd
    q : (n_sample, n_joint) [rad or m]
    order : {0, 1}
        1: then the slopes with the rate, too, end by end.

    Returns
    -------
    (n_sample, n_joint, (1 + order) * n_end)
    """
    columns = np.zeros((*q.shape, (1 + order) * len(ends)))
    for k, end in enumerate(ends):
        x = end.side * (q[:, end.joint] - end.angle_rad)
        columns[:, end.joint, k] = moment = end.side * np.exp(end.rate_1_rad * x)
        if order:
            columns[:, end.joint, len(ends) + k] = x * moment
    return columns


def stiff_ends(arm: Arm, trials: Sequence[Trial], fit: Callable[[Sequence[RangeEnd]], Fit]) -> list[RangeEnd]:
    """Return the ends at which swings show tissue that pulls back, all of one rate: that which fits best.

    An end is there if a fit without it is worse by a likelihood-ratio test. Swings come near an end a few times
    only, too few for the scatter of their scores to say how well its moment is known.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
    fit : callable
        Returns the moments at given ends, fitted with everything else, and the cost of the whole.
    """
    turning = [j for j, joint in enumerate(arm.joints) if joint.type == "revolute"]
    sides = (-1.0, 1.0)
    reached = {
        (j, side): side * max(float((side * trial.q[:, j]).max()) for trial in trials)
        for j in turning
        for side in sides
    }
    tried = [[RangeEnd(j, side, end, float(rate)) for (j, side), end in reached.items()] for rate in RATES]
    fits = [fit(ends) for ends in tried]
    best = int(np.argmin([one.cost for one in fits]))
    ends, moments, cost = tried[best], fits[best].values, fits[best].cost
    n_effective = sum(_independent_equations(trial) for trial in trials)
    false = _FALSE / (len(reached) * len(RATES))  # as many are looked at (Bonferroni)
    threshold = float(scipy.stats.chi2.isf(false, 1))
    without = [fit([one for one in ends if one != end]).cost for end in ends]
    return [
        end
        for end, moment, more in zip(ends, moments, without, strict=True)
        if moment > 0.0 and n_effective * np.log(more / cost) > threshold
    ]


def _independent_equations(trial: Trial) -> float:
    """Return how many equations of a trial are independent: two a period of the corner, for every joint."""
    corner_hz = min(trial.band_hz, trial.cutoff_hz, 0.5 / trial.dt_s)
    return trial.q.size * 2.0 * corner_hz * trial.dt_s
