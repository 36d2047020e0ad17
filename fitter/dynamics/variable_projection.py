"""The shooting problem linearised, its initial states eliminated (variable projection; Golub and Pereyra 1973).

Each window's columns and residuals are projected off those of its own initial state, so there may be any number of
windows. A step of the parameters then carries the initial states along.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from arm.model import Floats
from fitter.dynamics.shooting_problem import SearchPoint, ShootingProblem, start_error, window_cost
from fitter.dynamics.shooting_windows import ShootingWindow

#: Step of forward differences: of an initial value [rad, m, rad/s, m/s], and as a share of a parameter's scale
#: while its standard error is unknown. Far above rounding (1e-16), far below where the motion is curved.
FIRST_STEP = 1e-5
#: Least singular value of an initial state's columns, as a share of the largest, that is inverted: a joint that
#: sticks moves with none of them.
_RANK_TOLERANCE = 3e-3
#: Shares of an initial state's own step that are tried, where the whole of it makes its window's residuals larger.
_LINE_SEARCH = (1.0, 0.2, 0.0)


@dataclass(frozen=True)
class Linearisation:
    """The problem around one point in units of the noise, the starts eliminated: ``|r - J dx|^2``."""

    J: list[Floats]
    r: list[Floats]
    back: list[tuple[Floats, Floats]]  # a start's own step is ``back[0] - back[1] dx``
    prior: tuple[Floats, Floats] = field(default_factory=lambda: (np.zeros((0, 0)), np.zeros(0)))

    def rows(self) -> tuple[Floats, Floats]:
        """Return J and r of all windows and of the prior."""
        return np.vstack([*self.J, self.prior[0]]), np.concatenate([*self.r, self.prior[1]])


def linearised(problem: ShootingProblem, here: SearchPoint, over: Floats, noise: list[Floats]) -> Linearisation:
    """Return the problem around a point, slopes of x taken ``over`` (n_free,)."""
    others = [problem.machine(here.x + part) for part in np.diag(over)]
    machine, angles = problem.machine(here.x), problem.shooting.angles

    def around(
        window: ShootingWindow, start: Floats, residual: Floats, noise: Floats
    ) -> tuple[Floats, Floats, Floats, Floats]:
        simulated = window.measured - residual
        Jx = _slopes([angles(other, window, start) for other in others], simulated, over, noise)
        moves = np.full(len(start), FIRST_STEP)
        shifted = [angles(machine, window, start + move) for move in np.diag(moves)]
        Js = _slopes(shifted, simulated, moves, noise)
        r, own = (residual / noise).ravel(), start_error(window, start)
        if not (np.isfinite(Jx).all() and np.isfinite(Js).all()):
            return np.full_like(Jx, np.inf), r, np.zeros(0), np.zeros(0)
        if len(own):
            Js = np.vstack([Js, np.diag(1.0 / np.asarray(window.start_std))])
            Jx, r = np.vstack([Jx, np.zeros((len(own), Jx.shape[1]))]), np.concatenate([r, own])
        U, size, Vt = np.linalg.svd(Js, full_matrices=False)
        determined = size > _RANK_TOLERANCE * size[0]
        U, back = U[:, determined], Vt[determined].T / size[determined]
        return Jx - U @ (U.T @ Jx), r - U @ (U.T @ r), back @ (U.T @ r), back @ (U.T @ Jx)

    parts = list(problem.pool.map(around, problem.windows, here.starts, here.residuals, noise))
    known = np.isfinite(np.broadcast_to(problem.allowed.prior_std, here.x.shape))
    prior = np.diag(1.0 / np.broadcast_to(problem.allowed.prior_std, here.x.shape))[known]
    return Linearisation(
        [J for J, _, _, _ in parts],
        [r for _, r, _, _ in parts],
        [(own, slope) for _, _, own, slope in parts],
        (prior, problem.allowed.prior(here.x, problem.x0)[known]),
    )


def moved(
    problem: ShootingProblem, here: SearchPoint, linear: Linearisation, step: Floats, noise: list[Floats]
) -> SearchPoint:
    """Return the point after a step of x; each window takes its own share of its initial state's step."""
    machine = problem.machine(here.x + step)

    def move(
        window: ShootingWindow, start: Floats, residual: Floats, noise: Floats, back: tuple[Floats, Floats]
    ) -> list[Floats]:
        before, best, at, kept = window_cost(window, start, residual, noise), np.inf, start, residual
        for share in _LINE_SEARCH:
            tried_at = start + share * back[0] - back[1] @ step[: back[1].shape[1]]  # or starts alone move
            tried = window.measured - problem.shooting.angles(machine, window, tried_at)
            cost = window_cost(window, tried_at, tried, noise)
            if cost < best:
                best, at, kept = cost, tried_at, tried
            if best < before:
                break
        return [at, kept]

    parts = list(problem.pool.map(move, problem.windows, here.starts, here.residuals, noise, linear.back))
    return SearchPoint(here.x + step, [at for at, _ in parts], [kept for _, kept in parts])


def _slopes(moved: Sequence[Floats], simulated: Floats, over: Floats, noise: Floats) -> Floats:
    columns = [((angles - simulated) / h / noise).ravel() for angles, h in zip(moved, over, strict=True)]
    return np.stack(columns, axis=1) if columns else np.zeros((simulated.size, 0))
