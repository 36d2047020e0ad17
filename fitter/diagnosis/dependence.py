"""Whether the torque that is left depends on a variable at all, whatever the shape: Chatterjee's rank correlation.

Sorted by the variable, neighbouring residuals resemble each other if one is a function of the other:
``xi = 1 - 3 sum |r_(i+1) - r_i| / (n^2 - 1)`` with r the residual's ranks (Chatterjee 2021). What chance gives is
found by shifting the residual along the run, which keeps its own memory and the variable's.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import rankdata

from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.diagnosis.least_squares import N_INSTANT, N_SHIFTED
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression


@dataclass(frozen=True)
class Dependence:
    """How much a joint's remaining torque depends on one variable.

    Attributes
    ----------
    joint : int
        From 1.
    variable : str
    xi : float
        0 for independence, 1 for a function of the variable.
    p : float
        How often chance gives as much.
    """

    joint: int
    variable: str
    xi: float
    p: float


def remaining_torque(regression: Regression, model: Model, x: Floats, motion: Motion) -> Floats:
    """Return the torque that a model leaves, smoothed, NaN where stuck, (n_sample, n_joint) [N m or N]."""
    left = regression.equations.left(model, x, motion)
    left = lowpass(left, motion.dt_s, regression.weighting.seen_hz)
    return np.where(motion.stuck, np.nan, left)


def dependences(regression: Regression, final: Candidate) -> list[Dependence]:
    """Return the dependence of every joint's remaining torque on every variable."""
    n_joint, rng = regression.arm.n_joint, np.random.default_rng(0)
    motions = regression.motions
    left = np.concatenate([remaining_torque(regression, final.model, final.x, motion) for motion in motions])
    step = max(1, len(left) // N_INSTANT)
    columns: dict[str, Callable[[Motion], Floats]] = {"t": lambda motion: motion.t}
    for j in range(n_joint):
        columns |= {
            f"q{j + 1}": lambda motion, j=j: motion.q[:, j],  # type: ignore[misc]
            f"dq{j + 1}": lambda motion, j=j: motion.dq[:, j],  # type: ignore[misc]
            f"ddq{j + 1}": lambda motion, j=j: motion.ddq[:, j],  # type: ignore[misc]
        }
    found = []
    for j in range(n_joint):
        moving = np.flatnonzero(np.isfinite(left[:, j]))[::step]
        if len(moving) < 100:
            continue
        r = rankdata(left[moving, j], method="ordinal")
        shifts = rng.integers(len(r) // 20, len(r) - len(r) // 20, N_SHIFTED)
        for name, column in columns.items():
            order = np.argsort(np.concatenate([column(motion) for motion in motions])[moving], kind="stable")
            xi = _xi(r[order])
            chance = np.array([_xi(np.roll(r, shift)[order]) for shift in shifts])
            p = float((1 + np.count_nonzero(chance >= xi)) / (1 + N_SHIFTED))
            found.append(Dependence(j + 1, name, xi, p))
    return found


def _xi(ranks: Floats) -> float:
    n = len(ranks)
    return float(1.0 - 3.0 * np.abs(np.diff(ranks)).sum() / (n * n - 1.0))
