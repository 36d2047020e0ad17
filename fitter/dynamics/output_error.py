"""The simulated motion fitted to the measured one: output error, the thing a calibration is for.

Eq. (9) compares torques, and needs velocities and accelerations that nobody measured: their noise stands in the
regressors and shrinks what is learnt. Here the arm is simulated from its law's target (or from measured torque)
and compared with the angles alone. If these have white noise, that is maximum likelihood. The unknowns are the
free base parameters x, common to all windows, and the start s of each window. By Gauss and Newton, damped as
by Levenberg and Marquardt; the starts are eliminated window by window (variable projection), so there may be
any number of them. Parameters may have a prior, and must stay where limits, linearised at each step, are not
negative.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from arm.model import Floats
from fitter.dynamics.prior_and_limits import Allowed
from fitter.dynamics.shooting import Shooting
from fitter.dynamics.shooting_problem import SearchPoint, ShootingProblem, noise_std, pooled_rms, simulated
from fitter.dynamics.shooting_windows import ShootingWindow
from fitter.dynamics.variable_projection import FIRST_STEP, Linearisation, linearised, moved
from fitter.parallel.processors import processors
from fitter.search.constrained_step import constrained_step
from fitter.search.standard_errors import sandwich_covariance

#: Limits of a forward difference's step, as a share of a parameter's scale. Within them it is one standard
#: error of the parameter with the others known: dry friction makes the residuals rough on a finer scale.
_LEAST_STEP, _MOST_STEP = 1e-8, 1e-2
#: Squared Mahalanobis length of the next step at which the search ends: 0.1 standard errors.
_TOLERANCE = 0.1**2
#: The same, in which a search counts as converged whose cost no step makes smaller any more: one standard error.
_CONVERGED = 1.0**2
_ITERATIONS = 40
#: Levenberg and Marquardt's damping: first and least, and the one at which no step is left to try.
_DAMPING, _MOST_DAMPING = 1e-4, 1e8
#: Factors of the damping after a step that made the cost larger, and smaller (Marquardt 1963 has 10 for both).
_DAMPED_MORE, _DAMPED_LESS = 10.0, 100.0
#: Blocks of consecutive samples, over all windows, for the covariance of autocorrelated scores (batch means).
_BLOCKS = 400
#: Distance from the limits that a step aims at, in their units; they bend on the way, and it must end inside.
_MARGIN = 1e-3


@dataclass(frozen=True)
class MotionFit:
    """What fitting the motion has found.

    Attributes
    ----------
    x : (n_free,)
    covariance : (n_free, n_free)
        NaN where there is too little data for one. Its scatter is the windows' alone: a prior has none.
    inverse : (n_free, n_free)
        Of the information, the prior's included, in units of the noise; NaN where nothing was found.
    rms : (n_joint,) [rad or m]
        Simulated against measured angles.
    iterations : int
    converged : bool
    """

    x: Floats
    covariance: Floats
    inverse: Floats
    rms: Floats
    iterations: int
    converged: bool


def fit_motion(
    shooting: Shooting,
    windows: Sequence[ShootingWindow],
    complete: Callable[[Floats], Floats],
    x0: Floats,
    scale: Floats,
    progress: Callable[[int, float], None] | None = None,
    allowed: Allowed | None = None,
    own_noise: float = 0.0,
    iterations: int = _ITERATIONS,
) -> MotionFit:
    """Find the parameters whose simulated motion is nearest to the measured one.

    Parameters
    ----------
    shooting : Shooting
    windows : sequence of ShootingWindow
    complete : callable
        Turns the free parameters (n_free,) into all that the shooting takes.
    x0, scale : (n_free,)
        Where the search begins, and the size of each parameter that would make itself felt.
    progress : callable, optional
        Called after every iteration: how many are done, and the rms error [rad or m].
    allowed : Allowed, optional
        Where the parameters may be, and what was known of them; ``x0`` need not be there.
    own_noise : float
        What a window is weighted by, from 0 to 1. 0: by the noise of all of them (least squares). 1: by its own
        noise, so that the sum of ``n log rms`` over windows is made small (maximum likelihood where the model is
        off by more in some of them). Between: the sum of ``n rms^(2 - 2 own_noise)``.
    iterations : int
        Most steps.

    Returns
    -------
    MotionFit
    """
    with ThreadPoolExecutor(processors(len(windows))) as pool:  # kernels run without the interpreter's lock
        problem = ShootingProblem(
            shooting, windows, complete, np.array(x0), scale, allowed or Allowed(), pool, own_noise, iterations
        )
        return _search(problem, progress)


def _search(problem: ShootingProblem, progress: Callable[[int, float], None] | None) -> MotionFit:
    here = _started(problem, simulated(problem, _admitted(problem), [window.start for window in problem.windows]))
    pooled, over = pooled_rms(here.residuals), FIRST_STEP * problem.scale
    damping, distance, done = _DAMPING, np.inf, 0
    while np.isfinite(pooled).all():
        noise = noise_std(here.residuals, pooled, problem.own_noise)
        linear = linearised(problem, here, over, noise)
        J, r = linear.rows()
        if not np.isfinite(J).all():  # the neighbouring arm runs away: there is no slope to go down
            pooled = np.full_like(pooled, np.inf)
            break
        covariance, inverse = _covariance(problem, here.x, linear)
        J, r = _condensed(J, r)
        distance = _distance(_damped_step(problem, here.x, J, r, 0.0), J, covariance)
        std = 1.0 / np.maximum(np.linalg.norm(J, axis=0), 1e-300)
        over = np.clip(std, _LEAST_STEP * problem.scale, _MOST_STEP * problem.scale)
        if done == problem.iterations or (distance < _TOLERANCE and done > 0):
            break
        done += 1
        before, there = here.cost(problem, pooled), here
        while damping < _MOST_DAMPING:
            step = _damped_step(problem, here.x, J, r, damping)
            if problem.allowed.admits(here.x + step):
                there = moved(problem, here, linear, step, noise)
                if there.cost(problem, pooled) < before:
                    break
            damping *= _DAMPED_MORE
        else:
            break
        here, damping = there, max(damping / _DAMPED_LESS, _DAMPING)
        pooled = pooled_rms(here.residuals)
        if progress is not None:
            progress(done, float(np.sqrt(np.mean(pooled**2))))
    if not np.isfinite(pooled).all():
        nowhere = np.full((len(problem.x0), len(problem.x0)), np.nan)
        return MotionFit(here.x, nowhere, nowhere, np.full(len(pooled), np.inf), done, False)
    return MotionFit(here.x, covariance, inverse, pooled, done, distance < _CONVERGED)


def _started(problem: ShootingProblem, here: SearchPoint) -> SearchPoint:
    """Return the same parameters with better initial states; with poor ones the Jacobian is poor too."""
    pooled = pooled_rms(here.residuals)
    if not np.isfinite(pooled).all():
        return here
    noise = noise_std(here.residuals, pooled, problem.own_noise)
    linear = linearised(problem, here, np.zeros(0), noise)
    if not all(np.isfinite(J).all() for J in linear.J):
        return here
    return moved(problem, here, linear, np.zeros_like(here.x), noise)


def _condensed(J: Floats, r: Floats) -> tuple[Floats, Floats]:
    """Return the same least-squares problem in as many rows as there are parameters (QR)."""
    Q, R = np.linalg.qr(J)
    return np.asarray(R, dtype=np.float64), np.asarray(Q.T @ r, dtype=np.float64)


def _distance(step: Floats, J: Floats, covariance: Floats) -> float:
    """Return the squared Mahalanobis length of a step; without a covariance, in units of the noise."""
    if np.isfinite(covariance).all():
        std = np.sqrt(np.diag(covariance))
        unit = np.where(std > 0.0, std, 1.0)
        correlation = covariance / np.outer(unit, unit)
        return float(step / unit @ np.linalg.pinv(correlation, hermitian=True) @ (step / unit))
    return float(np.sum((J @ step) ** 2))


def _admitted(problem: ShootingProblem) -> Floats:
    """Return the parameters nearest to ``x0`` that are allowed, in units of the scale."""
    x = problem.x0.copy()
    for _ in range(_ITERATIONS):
        if problem.allowed.admits(x):
            break
        x += _damped_step(problem, x, np.diag(1.0 / problem.scale), (problem.x0 - x) / problem.scale, 0.0)
    return np.asarray(np.clip(x, problem.allowed.low, problem.allowed.high), dtype=np.float64)


def _damped_step(problem: ShootingProblem, x: Floats, J: Floats, r: Floats, damping: float) -> Floats:
    """Return Levenberg's and Marquardt's step, damped by a share of each column's length, to where it may lead."""
    damped = np.vstack([J, np.sqrt(damping) * np.diag(np.linalg.norm(J, axis=0))])
    right = np.concatenate([r, np.zeros(J.shape[1])])
    g, G = problem.allowed.inequalities(x, problem.scale, _MARGIN)
    step, _ = constrained_step(damped, right, g, G)
    return np.asarray(np.clip(x + step, problem.allowed.low, problem.allowed.high) - x, dtype=np.float64)


def _covariance(problem: ShootingProblem, x: Floats, linear: Linearisation) -> tuple[Floats, Floats]:
    """Return the covariance of x, and the inverse of its information; both are 0 across a limit that holds it."""
    J, r = _condensed(*linear.rows())
    g, G = problem.allowed.inequalities(x, problem.scale, _MARGIN)
    binds = constrained_step(J, r, g, G)[1]
    Z = scipy.linalg.null_space(G[binds]) if binds.any() else np.eye(len(x))
    W = np.asarray(np.linalg.qr(J @ Z).R, dtype=np.float64)
    total = sum(len(r) for r in linear.r)
    grams, scores, group = [], [], []
    for slopes, residual, window in zip(linear.J, linear.r, problem.windows, strict=True):
        parts = int(np.clip(round(_BLOCKS * len(residual) / total), 1, len(residual)))
        for rows in np.array_split(np.arange(len(residual)), parts):
            free = slopes[rows] @ Z
            grams.append(free.T @ free)
            scores.append(free.T @ residual[rows])
            group.append(window.trial)
    of_trial: NDArray[np.intp] = np.array(group, dtype=np.intp)
    covariance = sandwich_covariance(W, np.array(grams), np.array(scores), of_trial)
    inverse = np.linalg.pinv(W.T @ W, hermitian=True)
    return np.asarray(Z @ covariance @ Z.T), np.asarray(Z @ inverse @ Z.T)
