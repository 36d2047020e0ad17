"""Base parameters from the sums of some trials: eq. (9), searched by the genetic algorithm, then polished."""

from collections.abc import Callable, Mapping
from dataclasses import astuple, replace

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters, with_base_values
from arm.model import Arm, Estimate, Floats
from arm.regressor import standard_parameters
from fitter.dynamics.dynamics_fit import DynamicsFit, Method
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.regression_sums.torque_sums import TorqueSums
from fitter.search.fitted_parameter import FittedParameter, fitted_parameters, held_back
from fitter.search.genetic import INDIVIDUALS_PER_GENE, POPULATION, GeneticAlgorithm
from limbcal.errors import ConfigError, NotConverged
from limbcal.note import Note
from limbcal.suggestion import did_you_mean

#: Called after every generation: how many are done, and the best cost.
Progress = Callable[[int, float], None]

GENERATIONS = 1000
#: The search has found the optimum within its bounds if it is worse by no more than this fraction.
_FOUND = 1e-3


def fit_sums(
    arm: Arm,
    base: BaseParameters,
    sums: TorqueSums,
    *,
    seed: int | np.random.Generator = 0,
    population: int | None = None,
    generations: int = GENERATIONS,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    method: Method = "ga",
    progress: Progress | None = None,
) -> DynamicsFit:
    """Learn the base parameters from sums that may have come from anywhere; see `fitter.dynamics.fit`."""
    _check_names(base, bounds or {}, fixed or {})
    index = {name: k for k, name in enumerate(base.names)}
    prior = base.combination @ standard_parameters(arm)
    held = {index[name]: value for name, value in (fixed or {}).items()}
    problem = torque_problem(sums, prior, held)
    size = population or max(POPULATION, INDIVIDUALS_PER_GENE * len(problem.free))
    lower, upper = _bounds(base, problem, bounds or {})
    genes, stopped = problem.optimum_within(lower, upper)
    bred = 0
    if method == "ga":  # the local polish: on the sums one step ends it
        algorithm = GeneticAlgorithm(lower, upper, np.random.default_rng(seed), size)
        bred = _search(problem, algorithm, genes, generations, progress)
    notes: list[Note] = []
    while stopped.any():  # it is held at its bound: the others' errors are those of what is left
        notes += _stopped(base, problem, genes, stopped)
        held |= zip(problem.free[stopped].tolist(), genes[stopped].tolist(), strict=True)
        problem = torque_problem(sums, prior, held)
        genes, stopped = problem.optimum_within(*_bounds(base, problem, bounds or {}))
    return assembled(
        DynamicsFit(
            arm=arm,
            parameters={},
            method=method,
            objective="torque",
            generations=bred,
            population=size if method == "ga" else 0,
            samples=sums.samples,
            seconds=0.0,
            condition_number=problem.condition_number,
            cost=float(problem.cost(genes[None])[0]),
            base=base,
            problem=problem,
            covariance=problem.covariance(problem.complete(genes)),
            notes=tuple(notes),
        ),
        genes,
    )


def assembled(fit: DynamicsFit, genes: Floats) -> DynamicsFit:
    """Return a fit whose arm and parameters have these values of the free parameters, (n_free,).

    Where the degrees of freedom of its covariance are NaN nothing tells its errors, and no parameter is claimed.
    """
    base, problem, arm = fit.base, fit.problem, fit.arm
    values = problem.complete(genes)
    std = np.full(len(values), np.nan)
    std[problem.free] = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    parameters = fitted_parameters(base.names, values, std, base.units, problem.revealed, fit.freedom)
    if np.isnan(fit.freedom):
        parameters = held_back(parameters)
    learnt = {base.names[k]: Estimate(*astuple(parameters[base.names[k]])[:2]) for k in problem.free}
    static = {name: p for name, p in fit.parameters.items() if name not in parameters} or _static_friction(arm)
    return replace(
        fit,
        arm=replace(with_base_values(arm, base, values), base_parameters=learnt),
        parameters=parameters | static,
    )


def _check_names(base: BaseParameters, *named: Mapping[str, object]) -> None:
    unknown = sorted({name for names in named for name in names} - set(base.names))
    if unknown:
        raise ConfigError(
            f"no base parameter is called {', '.join(unknown)}; this arm has {', '.join(base.names)}"
            f"{did_you_mean(unknown[0], base.names)}"
        )


def _bounds(
    base: BaseParameters, problem: TorqueProblem, given: Mapping[str, tuple[float, float]]
) -> tuple[Floats, Floats]:
    lower, upper = problem.bounds()
    for gene, k in enumerate(problem.free):
        low, high = given.get(base.names[k], (lower[gene], upper[gene]))
        if not -np.inf < low <= high < np.inf:
            raise ConfigError(f"bounds of {base.names[k]} are {low} and {high}, expected finite and ordered")
        lower[gene], upper[gene] = low, high
    return lower, upper


def _stopped(
    base: BaseParameters, problem: TorqueProblem, genes: Floats, stopped: NDArray[np.bool_]
) -> list[Note]:
    """Return a note for each parameter that a bound stops, with what it would be without bounds."""
    without = problem.optimum()
    said = (
        "{} stops at its bound, {:.4g}: without bounds it would be {:.4g}; expected wider --bounds, or other data"
    )
    return [
        Note("bound", said.format(base.names[problem.free[k]], genes[k], without[k]))
        for k in np.flatnonzero(stopped)
    ]


def _search(
    problem: TorqueProblem,
    algorithm: GeneticAlgorithm,
    optimum: Floats,
    most: int,
    progress: Progress | None,
) -> int:
    """Search until the optimum is found, and return in how many generations.

    Raises
    ------
    NotConverged
        If it is not found in ``most``.
    """
    least = float(problem.cost(optimum[None])[0])
    allowed = _FOUND * problem.rest + 1e-9 * float(problem.z @ problem.z)
    while algorithm.generation < most:
        algorithm.tell(problem.cost(algorithm.ask()))
        if progress is not None:
            progress(algorithm.generation, algorithm.best_cost)
        if algorithm.best_cost - least <= allowed:
            return algorithm.generation
    raise NotConverged(
        f"after {most} generations of {len(algorithm.ask())} the cost {algorithm.best_cost:.6g} is still "
        f"{algorithm.best_cost - least:.3g} above the optimum; expected no more than {allowed:.3g}, "
        "so give it more generations"
    )


def _static_friction(arm: Arm) -> dict[str, FittedParameter]:
    return {
        f"F{i + 1}": FittedParameter(
            joint.friction.static_N_m, np.nan, "N m" if joint.type == "revolute" else "N", False
        )
        for i, joint in enumerate(arm.joints)
    }
