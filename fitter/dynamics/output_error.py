"""The simulated motion fitted to the measured one: output error, the thing a calibration is for.

Eq. (9) compares torques, and needs velocities and accelerations that nobody measured: their noise stands in the
regressors and shrinks what is learnt. Here the arm is simulated from its law's target (or from measured torque)
and compared with the angles alone. If these have white noise, that is maximum likelihood. The unknowns are the
free base parameters x, common to all stretches, and the start s of each stretch. By Gauss and Newton, damped as
by Levenberg and Marquardt; the starts are eliminated stretch by stretch (variable projection), so there may be
any number of them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.dynamics.shooting import Shooting
from fitter.dynamics.stretches import Stretch
from fitter.search.standard_errors import sandwich_covariance

#: Slopes are taken over this share of a parameter's scale at first. Then over one standard error, as it would be
#: if nothing else were sought: friction makes the motion depend on everything roughly, below what data can tell.
_SLOPE_STEP = 1e-5
_LEAST_SLOPE_STEP, _MOST_SLOPE_STEP = 1e-8, 1e-2
#: The search ends where a step promises to lower the cost by less than this, in units of the noise squared: the
#: parameters are then within a tenth of their standard errors of the optimum. Where no step keeps its promise,
#: friction having made the motion rough, less than one is good enough: the optimum is within a standard error.
_LITTLE, _GOOD_ENOUGH = 1e-2, 1.0
#: A start that moves nothing, of a joint that sticks, stays where it is.
_NO_EFFECT = 3e-3
#: Shares of a start's own step that are tried where the whole of it makes its stretch worse.
_SHARES = (1.0, 0.2, 0.0)
_ITERATIONS = 40
#: Damping to begin with; it is divided by a hundred or multiplied by ten.
_DAMPING, _MOST_DAMPING = 1e-4, 1e8
#: Blocks of consecutive samples, over all stretches, whose scores tell the answer's scatter.
_BLOCKS = 400


@dataclass(frozen=True)
class MotionFit:
    """What fitting the motion has found.

    Attributes
    ----------
    x : (n_free,)
    covariance : (n_free, n_free)
        NaN where there is too little data to tell.
    rms : (n_joint,) [rad or m]
        Simulated against measured angles.
    iterations : int
    converged : bool
    """

    x: Floats
    covariance: Floats
    rms: Floats
    iterations: int
    converged: bool


@dataclass(frozen=True)
class _Point:
    """Parameters, the starts of all stretches, and what they leave unexplained."""

    x: Floats
    starts: list[Floats]
    residuals: list[Floats]

    def cost(self, noise: Floats) -> float:
        return sum(_cost(residual, noise) for residual in self.residuals)


@dataclass(frozen=True)
class _Linear:
    """The problem around one point in units of the noise, the starts eliminated: ``|r - J dx|^2``."""

    J: list[Floats]
    r: list[Floats]
    back: list[tuple[Floats, Floats]]  # a start's own step is ``back[0] - back[1] dx``


def fit_motion(
    shooting: Shooting,
    stretches: Sequence[Stretch],
    complete: Callable[[Floats], Floats],
    x0: Floats,
    scale: Floats,
    progress: Callable[[int, float], None] | None = None,
) -> MotionFit:
    """Find the base parameters whose simulated motion is nearest to the measured one.

    Parameters
    ----------
    shooting : Shooting
    stretches : sequence of Stretch
    complete : callable
        Turns the free parameters (n_free,) into all base parameters.
    x0, scale : (n_free,)
        Where the search begins, and the size of each parameter that would make itself felt.
    progress : callable, optional
        Told after every iteration: how many are done, and the rms error in units of the noise.

    Returns
    -------
    MotionFit
    """
    here = _point(shooting, stretches, complete, np.array(x0), [stretch.start for stretch in stretches])
    noise, over = _noise(here.residuals), _SLOPE_STEP * scale
    damping, promise, done = _DAMPING, np.inf, 0
    while np.isfinite(noise).all():
        linear = _linearised(shooting, stretches, complete, here, over, noise)
        J, r = np.vstack(linear.J), np.concatenate(linear.r)
        if not np.isfinite(J).all():  # the arm beside this one runs away: there is no slope to go down
            noise = np.full_like(noise, np.inf)
            break
        promise = float(r @ r) - float(np.sum((r - J @ _damped_step(J, r, 0.0)) ** 2))
        told = 1.0 / np.maximum(np.linalg.norm(J, axis=0), 1e-300)
        over = np.clip(told, _LEAST_SLOPE_STEP * scale, _MOST_SLOPE_STEP * scale)
        if done == _ITERATIONS or (promise < _LITTLE and done > 0):
            break
        done += 1
        before, there = here.cost(noise), here
        while damping < _MOST_DAMPING:
            step = _damped_step(J, r, damping)
            there = _moved(shooting, stretches, complete, here, linear, step, noise)
            if there.cost(noise) < before:
                break
            damping *= 10.0
        else:
            break
        here, damping = there, max(damping / 100.0, _DAMPING)
        noise = _noise(here.residuals)
        if progress is not None:
            progress(done, float(np.sqrt(before / len(r))))
    if not np.isfinite(noise).all():
        nowhere = np.full((len(x0), len(x0)), np.nan)
        return MotionFit(here.x, nowhere, np.full(len(noise), np.inf), done, False)
    covariance = _covariance(linear, [stretch.trial for stretch in stretches])
    return MotionFit(here.x, covariance, noise, done, promise < _GOOD_ENOUGH)


def _point(
    shooting: Shooting,
    stretches: Sequence[Stretch],
    complete: Callable[[Floats], Floats],
    x: Floats,
    starts: list[Floats],
) -> _Point:
    chain = shooting.chain(complete(x))
    pairs = zip(stretches, starts, strict=True)
    return _Point(x, starts, [stretch.measured - shooting.angles(chain, stretch, at) for stretch, at in pairs])


def _moved(
    shooting: Shooting,
    stretches: Sequence[Stretch],
    complete: Callable[[Floats], Floats],
    here: _Point,
    linear: _Linear,
    step: Floats,
    noise: Floats,
) -> _Point:
    """Return where a step of x leads, with starts that go along; each stretch has the choice for itself."""
    chain = shooting.chain(complete(here.x + step))
    there = _Point(here.x + step, [], [])
    for stretch, start, residual, (own, slope) in zip(
        stretches, here.starts, here.residuals, linear.back, strict=True
    ):
        enough, best, at, left = _cost(residual, noise), np.inf, start, residual
        for share in _SHARES:
            tried_at = start + share * own - slope @ step
            tried = stretch.measured - shooting.angles(chain, stretch, tried_at)
            cost = _cost(tried, noise)
            if cost < best:
                best, at, left = cost, tried_at, tried
            if best < enough:
                break
        there.starts.append(at)
        there.residuals.append(left)
    return there


def _noise(residuals: Sequence[Floats]) -> Floats:
    """Return the rms of each joint, not below rounding: a joint that is met exactly would outweigh the others."""
    with np.errstate(over="ignore"):  # an arm that runs away is infinitely far off
        rms = np.sqrt(np.mean(np.concatenate(residuals) ** 2, axis=0))
    return np.asarray(np.maximum(rms, max(1e-9, 1e-6 * float(rms.max()))), dtype=np.float64)


def _cost(residual: Floats, noise: Floats) -> float:
    with np.errstate(over="ignore"):
        return float(np.sum((residual / noise) ** 2))


def _damped_step(J: Floats, r: Floats, damping: float) -> Floats:
    """Return Levenberg's and Marquardt's step, damped by a share of each column's length."""
    damped = np.vstack([J, np.sqrt(damping) * np.diag(np.linalg.norm(J, axis=0))])
    right = np.concatenate([r, np.zeros(J.shape[1])])
    return np.asarray(np.linalg.lstsq(damped, right, rcond=None)[0], dtype=np.float64)


def _linearised(
    shooting: Shooting,
    stretches: Sequence[Stretch],
    complete: Callable[[Floats], Floats],
    here: _Point,
    over: Floats,
    noise: Floats,
) -> _Linear:
    """Return the problem around a point, slopes of x taken ``over`` (n_free,)."""
    chains = [shooting.chain(complete(here.x + part)) for part in np.diag(over)]
    chain, linear = shooting.chain(complete(here.x)), _Linear([], [], [])
    for stretch, start, residual in zip(stretches, here.starts, here.residuals, strict=True):
        simulated = stretch.measured - residual
        Jx = _slopes([shooting.angles(other, stretch, start) for other in chains], simulated, over, noise)
        moves = np.full(len(start), _SLOPE_STEP)
        Js = _slopes(
            [shooting.angles(chain, stretch, start + move) for move in np.diag(moves)], simulated, moves, noise
        )
        r = (residual / noise).ravel()
        if not (np.isfinite(Jx).all() and np.isfinite(Js).all()):
            linear.J.append(np.full_like(Jx, np.inf))
            linear.r.append(r)
            continue
        U, size, Vt = np.linalg.svd(Js, full_matrices=False)
        told = size > _NO_EFFECT * size[0]
        U, back = U[:, told], Vt[told].T / size[told]
        linear.J.append(Jx - U @ (U.T @ Jx))
        linear.r.append(r - U @ (U.T @ r))
        linear.back.append((back @ (U.T @ r), back @ (U.T @ Jx)))
    return linear


def _slopes(moved: Sequence[Floats], simulated: Floats, over: Floats, noise: Floats) -> Floats:
    columns = [((angles - simulated) / h / noise).ravel() for angles, h in zip(moved, over, strict=True)]
    return np.stack(columns, axis=1) if columns else np.zeros((simulated.size, 0))


def _covariance(linear: _Linear, trials: Sequence[int]) -> Floats:
    """Return the covariance of x."""
    total = sum(len(r) for r in linear.r)
    grams, scores, group = [], [], []
    for J, r, trial in zip(linear.J, linear.r, trials, strict=True):
        parts = int(np.clip(round(_BLOCKS * len(r) / total), 1, len(r)))
        for rows in np.array_split(np.arange(len(r)), parts):
            grams.append(J[rows].T @ J[rows])
            scores.append(J[rows].T @ r[rows])
            group.append(trial)
    W = np.asarray(np.linalg.qr(np.vstack(linear.J)).R, dtype=np.float64)
    of_trial: NDArray[np.intp] = np.array(group, dtype=np.intp)
    return sandwich_covariance(W, np.array(grams), np.array(scores), of_trial)
