"""Multiple shooting as a least-squares problem: parameters, initial states, residuals and their noise.

The residuals are measured less simulated angles. Their standard deviation is estimated from themselves, joint by
joint: over all windows, in each window alone, or between the two.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.dynamics.prior_and_limits import Allowed
from fitter.dynamics.shooting import Machine, Shooting
from fitter.dynamics.shooting_windows import ShootingWindow

#: Initial values that each joint of a window has of its own: an angle and a velocity. They are degrees of freedom.
_STARTS = 2
#: Least rms of a joint's residuals [rad or m], and as a share of that of the joint with most of it: what rounding
#: leaves, or a joint that is met exactly would outweigh the others.
_LEAST_RMS, _LEAST_RMS_SHARE = 1e-9, 1e-6


@dataclass(frozen=True)
class ShootingProblem:
    """What stays the same during a search; the attributes are `fit_motion`'s parameters.

    Attributes
    ----------
    pool : ThreadPoolExecutor
        Simulates several windows at once.
    """

    shooting: Shooting
    windows: Sequence[ShootingWindow]
    complete: Callable[[Floats], Floats]
    x0: Floats
    scale: Floats
    allowed: Allowed
    pool: ThreadPoolExecutor
    own_noise: float
    iterations: int

    def machine(self, x: Floats) -> Machine:
        """Return the arm with these free parameters, (n_free,)."""
        return self.shooting.machine(self.complete(x))


@dataclass(frozen=True)
class SearchPoint:
    """Parameters, the initial states of all windows, and the residuals: measured less simulated angles."""

    x: Floats
    starts: list[Floats]
    residuals: list[Floats]

    def cost(self, problem: ShootingProblem, pooled: Floats) -> float:
        """Return the objective; where all windows have the same noise, the sum of squares in its units."""
        noise, power = noise_std(self.residuals, pooled, 1.0), 2.0 - 2.0 * problem.own_noise
        with np.errstate(over="ignore"):
            share = [np.asarray(one / pooled) for one in noise]
            sizes = [2.0 * np.log(one) if power == 0.0 else 2.0 / power * one**power for one in share]
        total = sum(len(r) * float(np.sum(size)) for r, size in zip(self.residuals, sizes, strict=True))
        for window, start in zip(problem.windows, self.starts, strict=True):
            total += float(np.sum(start_error(window, start) ** 2))
        return total + float(np.sum(problem.allowed.prior(self.x, problem.x0) ** 2))


def simulated(problem: ShootingProblem, x: Floats, starts: list[Floats]) -> SearchPoint:
    """Simulate all windows from some initial states."""
    machine = problem.machine(x)

    def residual(window: ShootingWindow, at: Floats) -> Floats:
        return window.measured - problem.shooting.angles(machine, window, at)

    return SearchPoint(x, starts, list(problem.pool.map(residual, problem.windows, starts)))


def noise_std(residuals: Sequence[Floats], pooled: Floats, own: float) -> list[Floats]:
    """Return the noise of each window and joint, (n_joint,) each: all windows' rms, its own, or between them.

    A window that is met exactly would outweigh all others. The degrees of freedom that its initial state took away
    therefore count with the pooled variance.
    """
    with np.errstate(over="ignore"):
        squares = [np.sum(residual**2, axis=0) for residual in residuals]
    return [
        np.asarray(pooled * ((square / pooled**2 + _STARTS) / (len(residual) + _STARTS)) ** (own / 2.0))
        for square, residual in zip(squares, residuals, strict=True)
    ]


def pooled_rms(residuals: Sequence[Floats]) -> Floats:
    """Return the rms of each joint, not below rounding: a joint that is met exactly would outweigh the others."""
    with np.errstate(over="ignore"):  # an arm that runs away is infinitely far off
        rms = np.sqrt(np.mean(np.concatenate(residuals) ** 2, axis=0))
    return np.asarray(np.maximum(rms, max(_LEAST_RMS, _LEAST_RMS_SHARE * float(rms.max()))), dtype=np.float64)


def window_cost(window: ShootingWindow, start: Floats, residual: Floats, noise: Floats) -> float:
    """Return a window's sum of squares in units of the noise, its initial state's prior included."""
    with np.errstate(over="ignore"):
        cost = float(np.sum((residual / noise) ** 2))
    return cost + float(np.sum(start_error(window, start) ** 2))


def start_error(window: ShootingWindow, start: Floats) -> Floats:
    """Return how far a start is from what was known of it, in its standard errors."""
    if window.start_std is None:
        return np.zeros(0)
    return np.asarray((window.start - start) / window.start_std, dtype=np.float64)
