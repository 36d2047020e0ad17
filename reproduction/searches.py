"""Searches compared by Fig. 6: the paper's three, and three that are in wide use today.

Each is handed a function to be made small, a box to look in, a start and a number of evaluations; what it asks for
is counted and kept by the function itself.
"""

import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import cma
import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Floats
from fitter.search.genetic import POPULATION, GeneticAlgorithm

#: Residuals of many individuals at once: (n, n_gene) -> (n, n_residual).
Residuals = Callable[[Floats], Floats]
#: Slopes are differences over this fraction of a gene's range.
_SLOPE = 1e-6


class EnoughError(Exception):
    """Raised to leave a search that has got there, or whose evaluations are used up."""


@dataclass
class Problem:
    """Residuals within a box; what was asked for is counted, and the best cost so far kept.

    Attributes
    ----------
    residuals : callable
    lower, upper : (n_gene,)
    budget : int
        Evaluations; whoever asks for more is stopped.
    goal : float
        Cost at which a search has got there and is stopped.
    evaluations : list of int
        Counted after every call.
    best : list of float
        The least cost by then.
    """

    residuals: Residuals
    lower: Floats
    upper: Floats
    budget: int
    goal: float = 0.0
    evaluations: list[int] = field(default_factory=list)
    best: list[float] = field(default_factory=list)

    def evaluate(self, genes: Floats) -> Floats:
        """Return the residuals of one or many individuals, (n, n_residual); outside the box too."""
        used = self.evaluations[-1] if self.evaluations else 0
        if used >= self.budget:
            raise EnoughError
        found = self.residuals(np.atleast_2d(genes))
        costs = np.einsum("ij,ij->i", found, found)
        least = float(np.min(costs, initial=np.inf, where=self.inside(np.atleast_2d(genes))))
        self.evaluations.append(used + len(costs))
        self.best.append(min(least, self.best[-1]) if self.best else least)
        if least <= self.goal:
            raise EnoughError
        return found

    def inside(self, genes: Floats) -> NDArray[np.bool_]:
        """Return which individuals lie in the box: an answer outside of it is none."""
        slack = 1e-9 * (self.upper - self.lower)
        held: NDArray[np.bool_] = np.all((genes >= self.lower - slack) & (genes <= self.upper + slack), axis=1)
        return held

    def cost(self, genes: Floats) -> float:
        """Return the cost of one individual."""
        return float(np.sum(self.evaluate(genes) ** 2))

    def costs(self, genes: Floats) -> Floats:
        """Return the costs of many individuals, (n,)."""
        found = self.evaluate(genes)
        return np.asarray(np.einsum("ij,ij->i", found, found), dtype=np.float64)

    def slopes(self, genes: Floats, here: Floats) -> Floats:
        """Return the jacobian of the residuals at one individual, (n_residual, n_gene), by differences."""
        steps = _SLOPE * (self.upper - self.lower)
        return np.asarray((self.evaluate(genes + np.diag(steps)) - here).T / steps, dtype=np.float64)


@dataclass(frozen=True)
class Trace:
    """What a search did: evaluations and the least cost after each call, and the time it took."""

    evaluations: Floats
    best: Floats
    seconds: float


def genetic(problem: Problem, _start: Floats, seed: int) -> None:
    """Search by the genetic algorithm of section 5, as the fits do."""
    search = GeneticAlgorithm(problem.lower, problem.upper, np.random.default_rng(seed), POPULATION)
    while True:
        search.tell(problem.costs(search.ask()))


def newton_raphson(problem: Problem, start: Floats, _seed: int) -> None:
    """Iterate ``x + J^+ (r* - r)`` as it stands: no damping, no bounds."""
    x = start.copy()
    while True:
        here = problem.evaluate(x)[0]
        step = np.linalg.lstsq(problem.slopes(x, here), -here, rcond=None)[0]
        x = x + step
        if not np.isfinite(x).all() or np.abs(step).max() < 1e-12:
            return


def nelder_mead(problem: Problem, start: Floats, _seed: int) -> None:
    """Search by the simplex of Nelder and Mead from the start, a tenth of the box wide."""
    width = 0.1 * (problem.upper - problem.lower)
    outwards = np.where(start + width > problem.upper, -width, width)
    options = {
        "initial_simplex": np.vstack([start, start + np.diag(outwards)]),
        "maxfev": problem.budget,
        "maxiter": problem.budget,
        "xatol": 1e-10,
        "fatol": 1e-14,
    }
    bounds = scipy.optimize.Bounds(problem.lower, problem.upper)
    scipy.optimize.minimize(problem.cost, start, method="Nelder-Mead", bounds=bounds, options=options)  # type: ignore[call-overload]


def cma_es(problem: Problem, start: Floats, seed: int) -> None:
    """Search by CMA-ES (Hansen's package) from the start, a quarter of the box wide."""
    width = problem.upper - problem.lower
    options = {
        "bounds": [[0.0] * len(width), [1.0] * len(width)],
        "seed": seed + 1,  # 0 means the clock there
        "verbose": -9,
        "maxfevals": problem.budget,
        "tolfun": 1e-14,
        "tolfunhist": 1e-14,
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        search = cma.CMAEvolutionStrategy((start - problem.lower) / width, 0.25, options)
        while not search.stop():
            asked = search.ask()
            search.tell(asked, problem.costs(problem.lower + np.array(asked) * width).tolist())


def differential(problem: Problem, _start: Floats, seed: int) -> None:
    """Search by differential evolution (scipy), without the polish at its end."""

    def costs(genes: Floats) -> Floats:
        return problem.costs(genes.T)

    scipy.optimize.differential_evolution(
        costs,  # type: ignore[arg-type]
        scipy.optimize.Bounds(problem.lower, problem.upper),
        rng=np.random.default_rng(seed),
        popsize=max(5, POPULATION // len(problem.lower)),
        maxiter=problem.budget,
        tol=0.0,
        atol=1e-14,
        polish=False,
        vectorized=True,
        updating="deferred",
    )


def bounded_least_squares(problem: Problem, start: Floats, _seed: int) -> None:
    """Search by a trust region within the box (scipy's least_squares) from the start."""

    def residual(x: Floats) -> Floats:
        return np.asarray(problem.evaluate(x)[0], dtype=np.float64)

    def slopes(x: Floats) -> Floats:
        return problem.slopes(x, residual(x))

    scipy.optimize.least_squares(
        residual,
        start,
        slopes,
        bounds=(problem.lower, problem.upper),
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-14,
    )


Search = Callable[[Problem, Floats, int], None]
SEARCHES: dict[str, Search] = {
    "GA (ours)": genetic,
    "Newton–Raphson": newton_raphson,
    "Nelder–Mead": nelder_mead,
    "CMA-ES": cma_es,
    "differential evolution": differential,
    "bounded least squares": bounded_least_squares,
}


def trace(search: Search, problem: Problem, start: Floats, seed: int) -> Trace:
    """Run one search to its end or to the end of its evaluations."""
    began = time.perf_counter()
    with suppress(EnoughError, np.linalg.LinAlgError):  # a Newton step that can't be taken ends the search too
        search(problem, start, seed)
    seconds = time.perf_counter() - began
    return Trace(np.array(problem.evaluations, dtype=float), np.array(problem.best), seconds)
