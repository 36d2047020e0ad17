"""Gains and base parameters by the simulated motion: the last word where angles were filtered.

A filter low enough to bring out accelerations bends the products of cosines, velocities and accelerations in
the law's equation a little, and no instrument undoes that. The simulated motion is compared with the angles as
they were measured (`fitter.dynamics.output_error`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from arm.base_parameters import BaseParameters
from arm.chain import Chain
from arm.drive_state import unchanging
from arm.integration import runge_kutta_steps
from arm.model import Arm, Floats
from fitter.data.trials import Trial
from fitter.dynamics.law_columns import LawColumns
from fitter.dynamics.law_fit import LawFit
from fitter.dynamics.output_error import fit_motion
from fitter.dynamics.shooting import Shooting
from fitter.dynamics.stretches import LONGEST_STEP_S, Stretch, stretches

#: Where a simulation can't follow whole trials, it begins anew so often: what swings undamped forgets its start.
_WINDOW_S = 1.0
#: A parameter makes itself felt by so many standard errors.
_FELT = 1e3


class Driven(NamedTuple):
    """An arm and the law that drives it, as simulations take them."""

    chain: Chain
    law: Floats


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

    def chain(self, values: Floats) -> Driven:  # type: ignore[override]  # gains change along with the arm
        """Return an arm with these base parameters and the law with these gains."""
        return Driven(super().chain(values[: self._columns.n_base]), self._columns.law_table(values))

    def angles(self, chain: Driven, stretch: Stretch, start: Floats) -> Floats:  # type: ignore[override]
        """Return the simulated angles of a stretch, (n_sample, n_joint); infinite where the arm ran away."""
        n = stretch.measured.shape[1]
        drive = np.tile(start[2 * n :], (len(stretch.drive), 1)) if stretch.free_target else stretch.drive
        motion = np.empty((4, *drive.shape))
        state = start[: 2 * n].reshape(2, n).copy()
        runge_kutta_steps(chain.chain, chain.law, False, drive, stretch.dt_s, state, motion, unchanging(n))
        return np.where(np.isfinite(motion[0]), motion[0], np.inf)


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
        parts = stretches(driven, trials, LONGEST_STEP_S, window_s)
        found = fit_motion(loop, parts, complete, fit.values[fit.free], _FELT * std)
        if found.converged and np.isfinite(found.covariance).all():
            return replace(fit, values=complete(found.x), covariance=found.covariance)
    return fit
