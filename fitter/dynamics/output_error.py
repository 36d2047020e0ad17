"""The simulated motion fitted to the measured one: output error, the thing a calibration is for.

Eq. (9) compares torques, and needs velocities and accelerations that nobody measured: their noise stands in the
regressors and shrinks what is learnt. Here the arm is simulated from its law's target (or from measured torque)
and compared with the angles alone. If these have white noise, that is maximum likelihood. The unknowns are the
free base parameters x, common to all stretches, and the start s of each stretch. By Gauss and Newton, damped as
by Levenberg and Marquardt; the starts are eliminated stretch by stretch (variable projection), so there may be
any number of them. Parameters may have a prior, and must stay where limits, linearised at each step, are not
negative.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from arm.model import Floats
from fitter.dynamics.shooting import Machine, Shooting
from fitter.dynamics.stretches import Stretch
from fitter.search.constrained_step import constrained_step
from fitter.search.standard_errors import sandwich_covariance
from fitter.side_by_side import processors

#: Slopes are taken over this share of a parameter's scale at first. Then over one standard error, as it would be
#: if nothing else were sought: friction makes the motion depend on everything roughly, below what data can tell.
_SLOPE_STEP = 1e-5
_LEAST_SLOPE_STEP, _MOST_SLOPE_STEP = 1e-8, 1e-2
#: The search ends where the next step is shorter than this, in standard errors squared: the parameters are then
#: within a tenth of these of the optimum. Where no step keeps its promise, friction having made the motion rough,
#: less than one is good enough: the optimum is within a standard error.
_LITTLE, _GOOD_ENOUGH = 1e-2, 1.0
#: A start that moves nothing, of a joint that sticks, stays where it is.
_NO_EFFECT = 3e-3
#: Shares of a start's own step that are tried where the whole of it makes its stretch worse.
_SHARES = (1.0, 0.2, 0.0)
_ITERATIONS = 40
#: Damping to begin with; it is divided by a hundred or multiplied by ten.
_DAMPING, _MOST_DAMPING = 1e-4, 1e8
#: Numbers of a joint that a stretch starts with: its angle and its velocity.
_STARTS = 2
#: Blocks of consecutive samples, over all stretches, whose scores tell the answer's scatter.
_BLOCKS = 400
#: A step aims this far inside the limits, which bend on the way, and must end inside.
_INSIDE = 1e-3


def _unlimited(x: Floats) -> tuple[Floats, Floats]:
    return np.zeros(0), np.zeros((0, len(x)))


@dataclass(frozen=True)
class Allowed:
    """Where the parameters may be, and what was known of them beforehand.

    Attributes
    ----------
    low, high : (n_free,) or float
    limits : callable
        Returns g (m,) and its slopes (m, n_free) at x: allowed is where no g is negative. In units in which one is
        large.
    prior_std : (n_free,) or float
        Standard errors of ``x0``; infinite where nothing was known.
    """

    low: Floats | float = -np.inf
    high: Floats | float = np.inf
    limits: Callable[[Floats], tuple[Floats, Floats]] = _unlimited
    prior_std: Floats | float = np.inf

    def inequalities(self, x: Floats, scale: Floats, inside: float = 0.0) -> tuple[Floats, Floats]:
        """Return g and its slopes at x, bounds included: ``g + G dx >= 0``.

        Parameters
        ----------
        x, scale : (n_free,)
            Bounds are in units of the scale.
        inside : float
            How far within the limits to stay.
        """
        g, G = self.limits(x)
        low, high = (np.broadcast_to(one, x.shape) for one in (self.low, self.high))
        unit = np.diag(1.0 / scale)
        g = np.concatenate([g - inside, (x - low) / scale, (high - x) / scale])
        G = np.vstack([G, unit, -unit])
        finite = np.isfinite(g)
        return g[finite], G[finite]

    def admits(self, x: Floats) -> bool:
        """Say whether x is within the limits."""
        return bool(np.all(self.limits(x)[0] >= 0.0))

    def prior(self, x: Floats, x0: Floats) -> Floats:
        """Return how far x is from what was known, in its standard errors, (n_free,)."""
        return np.asarray((x0 - x) / self.prior_std, dtype=np.float64)


@dataclass(frozen=True)
class MotionFit:
    """What fitting the motion has found.

    Attributes
    ----------
    x : (n_free,)
    covariance : (n_free, n_free)
        NaN where there is too little data to tell. Its scatter is the stretches' alone: a prior has none.
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


@dataclass(frozen=True)
class _Task:
    """Everything that does not change in a search."""

    shooting: Shooting
    stretches: Sequence[Stretch]
    complete: Callable[[Floats], Floats]
    x0: Floats
    scale: Floats
    allowed: Allowed
    pool: ThreadPoolExecutor
    own_noise: float
    iterations: int

    def machine(self, x: Floats) -> Machine:
        return self.shooting.machine(self.complete(x))


@dataclass(frozen=True)
class _Point:
    """Parameters, the starts of all stretches, and what they leave unexplained."""

    x: Floats
    starts: list[Floats]
    residuals: list[Floats]

    def cost(self, task: _Task, pooled: Floats) -> float:
        """Return what is made small; where all noise is alike, the sum of squares in its units."""
        noise, power = _noise(self.residuals, pooled, 1.0), 2.0 - 2.0 * task.own_noise
        with np.errstate(over="ignore"):
            share = [np.asarray(one / pooled) for one in noise]
            sizes = [2.0 * np.log(one) if power == 0.0 else 2.0 / power * one**power for one in share]
        total = sum(len(r) * float(np.sum(size)) for r, size in zip(self.residuals, sizes, strict=True))
        for stretch, start in zip(task.stretches, self.starts, strict=True):
            total += float(np.sum(_start_error(stretch, start) ** 2))
        return total + float(np.sum(task.allowed.prior(self.x, task.x0) ** 2))


@dataclass(frozen=True)
class _Linear:
    """The problem around one point in units of the noise, the starts eliminated: ``|r - J dx|^2``."""

    J: list[Floats]
    r: list[Floats]
    back: list[tuple[Floats, Floats]]  # a start's own step is ``back[0] - back[1] dx``
    prior: tuple[Floats, Floats] = field(default_factory=lambda: (np.zeros((0, 0)), np.zeros(0)))

    def rows(self) -> tuple[Floats, Floats]:
        """Return J and r of all stretches and of the prior."""
        return np.vstack([*self.J, self.prior[0]]), np.concatenate([*self.r, self.prior[1]])


def fit_motion(
    shooting: Shooting,
    stretches: Sequence[Stretch],
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
    stretches : sequence of Stretch
    complete : callable
        Turns the free parameters (n_free,) into all that the shooting takes.
    x0, scale : (n_free,)
        Where the search begins, and the size of each parameter that would make itself felt.
    progress : callable, optional
        Told after every iteration: how many are done, and the rms error [rad or m].
    allowed : Allowed, optional
        Where the parameters may be, and what was known of them; ``x0`` need not be there.
    own_noise : float
        What a stretch is weighted by, from 0 to 1. 0: by the noise of all of them (least squares). 1: by its own
        noise, so that the sum of ``n log rms`` over stretches is made small (maximum likelihood where the model is
        off by more in some of them). Between: the sum of ``n rms^(2 - 2 own_noise)``.
    iterations : int
        Most steps.

    Returns
    -------
    MotionFit
    """
    with ThreadPoolExecutor(processors(len(stretches))) as pool:  # kernels run without the interpreter's lock
        task = _Task(
            shooting, stretches, complete, np.array(x0), scale, allowed or Allowed(), pool, own_noise, iterations
        )
        return _search(task, progress)


def _search(task: _Task, progress: Callable[[int, float], None] | None) -> MotionFit:
    here = _started(task, _point(task, _admitted(task), [stretch.start for stretch in task.stretches]))
    pooled, over = _pooled(here.residuals), _SLOPE_STEP * task.scale
    damping, distance, done = _DAMPING, np.inf, 0
    while np.isfinite(pooled).all():
        noise = _noise(here.residuals, pooled, task.own_noise)
        linear = _linearised(task, here, over, noise)
        J, r = linear.rows()
        if not np.isfinite(J).all():  # the arm beside this one runs away: there is no slope to go down
            pooled = np.full_like(pooled, np.inf)
            break
        covariance, inverse = _covariance(task, here.x, linear)
        J, r = _condensed(J, r)
        distance = _distance(_damped_step(task, here.x, J, r, 0.0), J, covariance)
        told = 1.0 / np.maximum(np.linalg.norm(J, axis=0), 1e-300)
        over = np.clip(told, _LEAST_SLOPE_STEP * task.scale, _MOST_SLOPE_STEP * task.scale)
        if done == task.iterations or (distance < _LITTLE and done > 0):
            break
        done += 1
        before, there = here.cost(task, pooled), here
        while damping < _MOST_DAMPING:
            step = _damped_step(task, here.x, J, r, damping)
            if task.allowed.admits(here.x + step):
                there = _moved(task, here, linear, step, noise)
                if there.cost(task, pooled) < before:
                    break
            damping *= 10.0
        else:
            break
        here, damping = there, max(damping / 100.0, _DAMPING)
        pooled = _pooled(here.residuals)
        if progress is not None:
            progress(done, float(np.sqrt(np.mean(pooled**2))))
    if not np.isfinite(pooled).all():
        nowhere = np.full((len(task.x0), len(task.x0)), np.nan)
        return MotionFit(here.x, nowhere, nowhere, np.full(len(pooled), np.inf), done, False)
    return MotionFit(here.x, covariance, inverse, pooled, done, distance < _GOOD_ENOUGH)


def _started(task: _Task, here: _Point) -> _Point:
    """Return the same parameters with better starts: where the first ones are poor, so is every slope."""
    pooled = _pooled(here.residuals)
    if not np.isfinite(pooled).all():
        return here
    noise = _noise(here.residuals, pooled, task.own_noise)
    linear = _linearised(task, here, np.zeros(0), noise)
    if not all(np.isfinite(J).all() for J in linear.J):
        return here
    return _moved(task, here, linear, np.zeros_like(here.x), noise)


def _condensed(J: Floats, r: Floats) -> tuple[Floats, Floats]:
    """Return a problem of few rows with the same answers, less what no answer could reach."""
    Q, R = np.linalg.qr(J)
    return np.asarray(R, dtype=np.float64), np.asarray(Q.T @ r, dtype=np.float64)


def _distance(step: Floats, J: Floats, covariance: Floats) -> float:
    """Return how long a step is, squared: in its covariance, or where it is not known, in units of the noise."""
    if np.isfinite(covariance).all():
        std = np.sqrt(np.diag(covariance))
        unit = np.where(std > 0.0, std, 1.0)
        correlation = covariance / np.outer(unit, unit)
        return float(step / unit @ np.linalg.pinv(correlation, hermitian=True) @ (step / unit))
    return float(np.sum((J @ step) ** 2))


def _admitted(task: _Task) -> Floats:
    """Return the parameters nearest to ``x0`` that are allowed, in units of the scale."""
    x = task.x0.copy()
    for _ in range(_ITERATIONS):
        if task.allowed.admits(x):
            break
        x += _damped_step(task, x, np.diag(1.0 / task.scale), (task.x0 - x) / task.scale, 0.0)
    return np.asarray(np.clip(x, task.allowed.low, task.allowed.high), dtype=np.float64)


def _point(task: _Task, x: Floats, starts: list[Floats]) -> _Point:
    machine = task.machine(x)

    def left(stretch: Stretch, at: Floats) -> Floats:
        return stretch.measured - task.shooting.angles(machine, stretch, at)

    return _Point(x, starts, list(task.pool.map(left, task.stretches, starts)))


def _moved(task: _Task, here: _Point, linear: _Linear, step: Floats, noise: list[Floats]) -> _Point:
    """Return where a step of x leads, with starts that go along; each stretch has the choice for itself."""
    machine = task.machine(here.x + step)

    def move(
        stretch: Stretch, start: Floats, residual: Floats, noise: Floats, back: tuple[Floats, Floats]
    ) -> list[Floats]:
        enough, best, at, left = _cost(stretch, start, residual, noise), np.inf, start, residual
        for share in _SHARES:
            tried_at = start + share * back[0] - back[1] @ step[: back[1].shape[1]]  # or starts alone move
            tried = stretch.measured - task.shooting.angles(machine, stretch, tried_at)
            cost = _cost(stretch, tried_at, tried, noise)
            if cost < best:
                best, at, left = cost, tried_at, tried
            if best < enough:
                break
        return [at, left]

    moved = list(task.pool.map(move, task.stretches, here.starts, here.residuals, noise, linear.back))
    return _Point(here.x + step, [at for at, _ in moved], [left for _, left in moved])


def _noise(residuals: Sequence[Floats], pooled: Floats, own: float) -> list[Floats]:
    """Return the noise of each stretch and joint, (n_joint,) each: all stretches' rms, its own, or between them.

    A stretch that is met exactly would outweigh all others; so what its start's numbers have taken away counts as
    all stretches' rms has it.
    """
    with np.errstate(over="ignore"):
        squares = [np.sum(residual**2, axis=0) for residual in residuals]
    return [
        np.asarray(pooled * ((square / pooled**2 + _STARTS) / (len(residual) + _STARTS)) ** (own / 2.0))
        for square, residual in zip(squares, residuals, strict=True)
    ]


def _pooled(residuals: Sequence[Floats]) -> Floats:
    """Return the rms of each joint, not below rounding: a joint that is met exactly would outweigh the others."""
    with np.errstate(over="ignore"):  # an arm that runs away is infinitely far off
        rms = np.sqrt(np.mean(np.concatenate(residuals) ** 2, axis=0))
    return np.asarray(np.maximum(rms, max(1e-9, 1e-6 * float(rms.max()))), dtype=np.float64)


def _cost(stretch: Stretch, start: Floats, residual: Floats, noise: Floats) -> float:
    with np.errstate(over="ignore"):
        cost = float(np.sum((residual / noise) ** 2))
    return cost + float(np.sum(_start_error(stretch, start) ** 2))


def _start_error(stretch: Stretch, start: Floats) -> Floats:
    """Return how far a start is from what was known of it, in its standard errors."""
    if stretch.start_std is None:
        return np.zeros(0)
    return np.asarray((stretch.start - start) / stretch.start_std, dtype=np.float64)


def _damped_step(task: _Task, x: Floats, J: Floats, r: Floats, damping: float) -> Floats:
    """Return Levenberg's and Marquardt's step, damped by a share of each column's length, to where it may lead."""
    damped = np.vstack([J, np.sqrt(damping) * np.diag(np.linalg.norm(J, axis=0))])
    right = np.concatenate([r, np.zeros(J.shape[1])])
    g, G = task.allowed.inequalities(x, task.scale, _INSIDE)
    step, _ = constrained_step(damped, right, g, G)
    return np.asarray(np.clip(x + step, task.allowed.low, task.allowed.high) - x, dtype=np.float64)


def _linearised(task: _Task, here: _Point, over: Floats, noise: list[Floats]) -> _Linear:
    """Return the problem around a point, slopes of x taken ``over`` (n_free,)."""
    others = [task.machine(here.x + part) for part in np.diag(over)]
    machine, angles = task.machine(here.x), task.shooting.angles

    def around(
        stretch: Stretch, start: Floats, residual: Floats, noise: Floats
    ) -> tuple[Floats, Floats, Floats, Floats]:
        simulated = stretch.measured - residual
        Jx = _slopes([angles(other, stretch, start) for other in others], simulated, over, noise)
        moves = np.full(len(start), _SLOPE_STEP)
        moved = [angles(machine, stretch, start + move) for move in np.diag(moves)]
        Js = _slopes(moved, simulated, moves, noise)
        r, own = (residual / noise).ravel(), _start_error(stretch, start)
        if not (np.isfinite(Jx).all() and np.isfinite(Js).all()):
            return np.full_like(Jx, np.inf), r, np.zeros(0), np.zeros(0)
        if len(own):
            Js = np.vstack([Js, np.diag(1.0 / np.asarray(stretch.start_std))])
            Jx, r = np.vstack([Jx, np.zeros((len(own), Jx.shape[1]))]), np.concatenate([r, own])
        U, size, Vt = np.linalg.svd(Js, full_matrices=False)
        told = size > _NO_EFFECT * size[0]
        U, back = U[:, told], Vt[told].T / size[told]
        return Jx - U @ (U.T @ Jx), r - U @ (U.T @ r), back @ (U.T @ r), back @ (U.T @ Jx)

    parts = list(task.pool.map(around, task.stretches, here.starts, here.residuals, noise))
    known = np.isfinite(np.broadcast_to(task.allowed.prior_std, here.x.shape))
    prior = np.diag(1.0 / np.broadcast_to(task.allowed.prior_std, here.x.shape))[known]
    return _Linear(
        [J for J, _, _, _ in parts],
        [r for _, r, _, _ in parts],
        [(own, slope) for _, _, own, slope in parts],
        (prior, task.allowed.prior(here.x, task.x0)[known]),
    )


def _slopes(moved: Sequence[Floats], simulated: Floats, over: Floats, noise: Floats) -> Floats:
    columns = [((angles - simulated) / h / noise).ravel() for angles, h in zip(moved, over, strict=True)]
    return np.stack(columns, axis=1) if columns else np.zeros((simulated.size, 0))


def _covariance(task: _Task, x: Floats, linear: _Linear) -> tuple[Floats, Floats]:
    """Return the covariance of x, and the inverse of its information; both are 0 across a limit that holds it."""
    J, r = _condensed(*linear.rows())
    g, G = task.allowed.inequalities(x, task.scale, _INSIDE)
    binds = constrained_step(J, r, g, G)[1]
    Z = scipy.linalg.null_space(G[binds]) if binds.any() else np.eye(len(x))
    W = np.asarray(np.linalg.qr(J @ Z).R, dtype=np.float64)
    total = sum(len(r) for r in linear.r)
    grams, scores, group = [], [], []
    for slopes, left, stretch in zip(linear.J, linear.r, task.stretches, strict=True):
        parts = int(np.clip(round(_BLOCKS * len(left) / total), 1, len(left)))
        for rows in np.array_split(np.arange(len(left)), parts):
            free = slopes[rows] @ Z
            grams.append(free.T @ free)
            scores.append(free.T @ left[rows])
            group.append(stretch.trial)
    of_trial: NDArray[np.intp] = np.array(group, dtype=np.intp)
    covariance = sandwich_covariance(W, np.array(grams), np.array(scores), of_trial)
    inverse = np.linalg.pinv(W.T @ W, hermitian=True)
    return np.asarray(Z @ covariance @ Z.T), np.asarray(Z @ inverse @ Z.T)
