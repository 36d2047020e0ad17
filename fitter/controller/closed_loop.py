"""Gains and base parameters by the simulated motion: the last word where angles were filtered.

A filter low enough to bring out accelerations bends the products of cosines, velocities and accelerations in
the law's equation a little, and no instrument undoes that. The simulated motion is compared with the angles as
they were measured (`fitter.dynamics.output_error`).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from fitter.controller.law_columns import LawColumns
from fitter.controller.law_fit import LawFit
from fitter.data.trial import Trial
from fitter.dynamics.output_error import fit_motion
from fitter.dynamics.shooting import Machine, Shooting
from fitter.dynamics.shooting_windows import LONGEST_STEP_S, shooting_windows

#: Length of shooting windows [s] where a simulation cannot follow whole trials, such as an undamped swing.
_WINDOW_S = 1.0
#: A parameter's scale in a search, in its standard errors.
_SCALE_STD = 1e3


class ClosedLoop(Shooting):
    """Simulations of an arm for any base parameters and gains.

    Parameters
    ----------
    arm : Arm
        Its geometry and static friction.
    base : BaseParameters
    columns : LawColumns
        What the values are.
    """

    def __init__(self, arm: Arm, base: BaseParameters, columns: LawColumns) -> None:
        super().__init__(replace(arm, control=columns.control(np.zeros(len(columns.names)))), base)
        self._columns = columns

    def machine(self, values: Floats) -> Machine:
        """Return an arm with these base parameters and the law with these gains."""
        machine = super().machine(values[: self._columns.n_base])
        return machine._replace(law=self._columns.law_table(values))


def polished(fit: LawFit, arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> LawFit:
    """Return a fit whose simulated motion is nearest to the measured angles; the same fit if none is found.

    Parameters
    ----------
    fit : LawFit
    arm : Arm
    base : BaseParameters
    trials : sequence of Trial
        Those that it was learnt from.
    """
    std = fit.std()[fit.free]
    if not any(trial.whole for trial in trials):
        return fit  # nothing was filtered: the equations hold as they are
    if not (fit.converged and np.isfinite(std).all()):
        return fit
    driven, loop = fit.arm(arm, base), ClosedLoop(arm, base, fit.columns)

    def complete(x: Floats) -> Floats:
        whole = fit.values.copy()
        whole[fit.free] = x
        return whole

    for window_s in (np.inf, _WINDOW_S):
        parts = shooting_windows(driven, trials, LONGEST_STEP_S, window_s)
        found = fit_motion(loop, parts, complete, fit.values[fit.free], _SCALE_STD * std)
        if found.converged and np.isfinite(found.covariance).all():
            return replace(fit, values=complete(found.x), covariance=found.covariance)
    return fit
