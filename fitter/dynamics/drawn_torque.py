r"""What is wrong with a calibrated dynamics because of what is wrong with the motion and the geometry.

To each draw of the motions and of the geometry belongs a residual torque at the parameters that were found,
:math:`\epsilon_b = \tau(q_b, \dot q_b) - W(q_b, \dot q_b, \ddot q_b; g_b)\, p`, and to first order the answer that
belongs to it lies :math:`\delta p_b = (W^T W)^{-1} W^T (\epsilon_b - \epsilon)` from the one that was found. With
unknown targets each trial's mean is taken off both, as in the fit itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.standstill import REST_SPEED, is_moving
from fitter.data.torque_target import has_unknown_target, target_holds_from, torque_target
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit

_GEOMETRY = ("alpha_rad", "a_m", "d_m", "beta_rad", "theta_offset_rad")


@dataclass(frozen=True)
class DrawnDynamics:
    """Base parameters as they may be.

    Attributes
    ----------
    departures : (n_draw, n_free)
        From the free parameters that were found.
    residual_power : (n_draw,) [(N m)^2]
        What the draws' own answers leave of the torque, squared and summed.
    """

    departures: Floats
    residual_power: Floats


def drawn_dynamics(
    fit: DynamicsFit, arm: Arm, trials: Sequence[Trial], geometries: Floats | None, rest_speed: float = REST_SPEED
) -> DrawnDynamics | None:
    """Return what the draws of the trials' motions make of a fit, or None where one has no draws.

    Parameters
    ----------
    fit : DynamicsFit
        Of the torque, found from these trials.
    arm : Arm
        The arm that was given to the fit.
    geometries : (n_draw, n_joint, 5) or None
        The geometry of each draw; without it the arm's is exact.
    """
    draws = [trial.draws for trial in trials]
    if not trials or any(one is None for one in draws) or any(np.isfinite(trial.band_hz) for trial in trials):
        return None
    base, problem = fit.base, fit.problem
    values = np.array([fit.parameters[name].value for name in base.names])
    n_draw = len(draws[0].q) if draws[0] is not None else 0
    arms = [arm] * n_draw if geometries is None else [_with(arm, one) for one in geometries]
    scores, power = np.zeros((n_draw, len(problem.free))), np.zeros(n_draw)
    for trial, one in zip(trials, draws, strict=True):
        assert one is not None
        unknown = has_unknown_target(arm, trial)
        rows = slice(target_holds_from(trial) if unknown else 0, len(trial.q))
        moving = is_moving(trial.dq[rows], rest_speed) & trial.counted[rows]
        slopes, residual = _residual(arm, base, trial, rows, values)
        slopes = _counted(slopes, moving, unknown)[..., problem.free]
        for b in range(n_draw):
            moved = replace(trial, q=one.q[b], dq=one.dq[b], ddq=one.ddq[b])
            change = _counted(_residual(arms[b], base, moved, rows, values)[1] - residual, moving, unknown)
            scores[b] += np.einsum("tj,tjp->p", change, slopes)
            power[b] += np.sum(change**2)
    answers = np.asarray(np.linalg.solve(problem.W.T @ problem.W, scores.T).T, dtype=np.float64)
    return DrawnDynamics(answers, power - np.einsum("bi,bi->b", scores, answers))


def _with(arm: Arm, geometry: Floats) -> Arm:
    return arm.with_joints(**dict(zip(_GEOMETRY, geometry.T, strict=True)))


def _residual(arm: Arm, base: BaseParameters, trial: Trial, rows: slice, values: Floats) -> tuple[Floats, Floats]:
    """Return the regressor's rows and the torque that they leave."""
    Y = regressor(arm, trial.q[rows], trial.dq[rows], trial.ddq[rows])[..., base.independent]
    return Y, torque_target(arm, trial)[rows] - Y @ values


def _counted(rows: Floats, moving: NDArray[np.bool_], centred: bool) -> Floats:
    """Return what counts of some rows (n, n_joint, …), less each joint's mean where that is fitted along."""
    counts = moving.reshape(*moving.shape, *[1] * (rows.ndim - 2))
    rows = rows * counts
    if centred:
        rows = (rows - rows.sum(axis=0) / np.maximum(counts.sum(axis=0), 1)) * counts
    return np.asarray(rows, dtype=np.float64)
