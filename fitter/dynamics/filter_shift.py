"""How far a filter shifts the answer of eq. (9), from the answer behind a filter with twice the corner.

A torque is not linear in the angles. Filtered angles in the regressor and a filtered torque so differ by what the
filter bends, a shift that no scatter of residuals shows. Of a Butterworth filter of order 4, run both ways, it
falls with the eighth power of the corner: twice the corner leaves next to nothing of it. The two answers therefore
differ by the shift and by noise. Their difference's square is on average no less than that of the shift, and
variance and shift together are the mean square error.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from arm.model import Arm
from fitter.data.refilter import refiltered
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.torque_problem import torque_problem
from fitter.dynamics.torque_search import assembled
from fitter.regression_sums.torque_sums import add_up
from fitter.regression_sums.trial_sums import trial_sums


def with_filter_shift(
    fit: DynamicsFit, arm: Arm, trials: Sequence[Trial], fixed: Mapping[str, float], rest_speed: float
) -> DynamicsFit:
    """Return a fit of eq. (9) whose covariance has in it how far the filter shifts the answer.

    Parameters
    ----------
    fit : DynamicsFit
        By least squares on `trial_sums` of the same trials.
    arm : Arm
        As it was before the fit.
    trials : sequence of Trial
        Those that were never filtered shift nothing.
    fixed : mapping from name to value
    rest_speed : float [rad/s or m/s]
    """
    wide = refiltered(trials)
    if all(after is before for after, before in zip(wide, trials, strict=True)):
        return fit
    base, free = fit.base, fit.problem.free
    values = np.array([fit.parameters[name].value for name in base.names])
    held = {base.names.index(name): value for name, value in fixed.items() if name in base.names}
    held |= {int(k): float(values[k]) for k in np.setdiff1d(np.arange(len(values)), free)}
    problem = torque_problem(add_up([trial_sums(arm, base, trial, rest_speed) for trial in wide]), values, held)
    shift = (problem.complete(problem.optimum()) - values)[free]
    return assembled(replace(fit, covariance=fit.covariance + np.outer(shift, shift)), values[free])
