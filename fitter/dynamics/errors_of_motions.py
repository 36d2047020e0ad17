"""How well a fit of the torque is known: by draws of its motions, by how far motions disagree, or by samples."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Arm, Floats
from fitter.data.trial import Trial
from fitter.dynamics.drawn_torque import drawn_dynamics
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.torque_search import assembled
from fitter.search.clusters import covariance_of_motions, motion_notes
from fitter.search.drawn import covariance_of


def with_errors_of_motions(
    fit: DynamicsFit, arm: Arm, trials: Sequence[Trial], geometries: Floats | None, rest_speed: float
) -> DynamicsFit:
    """Return a fit of the torque with what its motions say of its errors.

    Parameters
    ----------
    fit : DynamicsFit
        With the covariance that its samples tell, not weighted by their noise.
    arm : Arm
        That was learnt from, without its effects.
    trials : sequence of Trial
        Learnt from. Draws of all of them say how well their trackers know them.
    geometries : (n_draw, n_joint, 5) or None
        As the arm may be, where the trials have draws.
    rest_speed : float [rad/s or m/s]
        A joint this slow is taken to be at rest.
    """
    drawn = drawn_dynamics(fit, arm, trials, geometries, rest_speed) if fit.objective == "torque" else None
    if drawn is None:
        return known_by_motions(fit, any(trial.tracked for trial in trials))
    covariance = covariance_of(drawn.departures, drawn.residual_power, fit.cost, fit.covariance)
    return with_covariance(fit, covariance, float(len(drawn.departures)))


def known_by_motions(fit: DynamicsFit, tracked: bool) -> DynamicsFit:
    """Return a fit with how well motions and their samples say that it is known.

    What a single tracked motion tells is held back: nothing says how far off it is.

    Parameters
    ----------
    fit : DynamicsFit
    tracked : bool
        Whether a tracker made the motions, see `fitter.search.clusters.covariance_of_motions`.
    """
    problem = fit.problem
    values = np.array([fit.parameters[name].value for name in fit.base.names])
    grams = problem.sums.gram.sum(axis=1)[:, problem.free[:, None], problem.free]
    scores = problem.sums.scores(values)[:, problem.free]
    covariance, freedom = covariance_of_motions(
        fit.covariance, problem.W, grams, scores, problem.sums.trial, tracked
    )
    return with_covariance(replace(fit, notes=(*fit.notes, *motion_notes(freedom))), covariance, freedom)


def with_covariance(fit: DynamicsFit, covariance: Floats, freedom: float) -> DynamicsFit:
    """Return a fit whose free parameters have this covariance, estimated with these degrees of freedom.

    Parameters
    ----------
    fit : DynamicsFit
    covariance : (n_free, n_free)
    freedom : float
    """
    values = np.array([fit.parameters[name].value for name in fit.base.names])[fit.problem.free]
    return assembled(replace(fit, covariance=covariance, freedom=freedom), values)
