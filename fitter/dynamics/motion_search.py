"""The polish of a torque fit by simulated motion."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.output_error import fit_motion
from fitter.dynamics.shooting import Shooting, finest_needed
from fitter.dynamics.shooting_windows import LONGEST_STEP_S, ShootingWindow, shooting_windows
from fitter.dynamics.torque_search import assembled
from limbcal.note import Note


def polished_by_motion(
    fit: DynamicsFit,
    trials: Sequence[Trial],
    window_s: float,
    progress: Callable[[int, float], None] | None = None,
) -> DynamicsFit:
    """Return a fit that makes the simulated motion small, beginning with one that made the torque small.

    Parameters
    ----------
    fit : DynamicsFit
    trials : sequence of Trial
        Those that it was learnt from.
    window_s : float
        With ``law = "measured"``, how long a simulation runs before it starts anew.
    progress : callable, optional
        Called after every iteration: how many are done, and the rms error in units of the noise.

    Returns
    -------
    DynamicsFit
        The same fit, with a note, where the search came to nothing.
    """
    arm, problem = fit.arm, fit.problem
    window = window_s if arm.control.law == "measured" else np.inf
    shooting = Shooting(arm, fit.base)
    x0 = np.array([fit.parameters[fit.base.names[k]].value for k in problem.free])

    def cut(step_s: float) -> list[ShootingWindow]:
        return shooting_windows(arm, trials, step_s, window)

    step_s = finest_needed(shooting, cut, problem.complete(x0), LONGEST_STEP_S)
    found = fit_motion(shooting, cut(step_s), problem.complete, x0, np.abs(problem.bounds()[1]), progress)
    if not found.converged:
        said = "the simulated motion could not be fitted; these are the parameters of the torque fit"
        return replace(fit, notes=(*fit.notes, Note("search", said)))
    fit = replace(fit, objective="motion", covariance=found.covariance, cost=float(problem.cost(found.x[None])[0]))
    return assembled(fit, found.x)
