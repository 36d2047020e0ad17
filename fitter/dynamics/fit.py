"""Dynamic parameters from motion and torque: eq. (4), (8) and (9), searched by the genetic algorithm."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Literal

import numpy as np

from arm.base_parameters import BaseParameters, with_base_values
from arm.model import Arm, Estimate, Floats
from arm.regressor import standard_parameters
from fitter.data.first_rest import REST_SPEED
from fitter.data.trials import Trial
from fitter.dynamics.evaluation import Score
from fitter.dynamics.structure import structural_parameters
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.dynamics.torque_sums import TorqueSums, add_up
from fitter.dynamics.trial_sums import trial_sums
from fitter.search.fitted_parameter import FittedParameter, fitted_parameters
from fitter.search.genetic import INDIVIDUALS_PER_GENE, POPULATION, GeneticAlgorithm
from limbcal.errors import ConfigError, DataError, NotConverged

Method = Literal["ga", "least-squares"]
#: Told after every generation: how many are done, and the best cost.
Progress = Callable[[int, float], None]

GENERATIONS = 1000
#: The search has ended too soon if it is worse than the optimum within its bounds by more than this share.
_NOT_CONVERGED = 1e-3


@dataclass(frozen=True)
class DynamicsFit:
    """What was learnt of an arm's dynamics.

    Attributes
    ----------
    arm : Arm
        The arm with what was learnt in ``[base_parameters]``, and links and friction that have these values.
    parameters : mapping from name to FittedParameter
        The base parameters, then the static frictions F, which eq. (8) does not contain.
    method : {"ga", "least-squares"}
    generations, population, samples : int
    seconds : float
    condition_number : float
        Of the columns of the learnt parameters, each scaled to length one.
    cost : float
        Eq. (9) summed over samples and joints.
    """

    arm: Arm
    parameters: Mapping[str, FittedParameter]
    method: Method
    generations: int
    population: int
    samples: int
    seconds: float
    condition_number: float
    cost: float


def fit_dynamics(
    arm: Arm,
    learn: Sequence[Trial],
    *,
    seed: int | np.random.Generator = 0,
    population: int | None = None,
    generations: int = GENERATIONS,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    method: Method = "ga",
    rest_speed: float = REST_SPEED,
    progress: Progress | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> DynamicsFit:
    """Learn the base parameters of an arm from some trials.

    Parameters
    ----------
    arm : Arm
        Its geometry, gravity and control law; its own dynamics are the prior of what the data can't tell.
    learn : sequence of Trial
    seed : int or numpy.random.Generator
    population : int, optional
        Default 100, or 8 individuals a parameter where that is more.
    generations : int
    bounds : mapping from name to (lower, upper), optional
        Default: the box of `TorqueProblem.bounds`, which is derived from how large the torque is.
    fixed : mapping from name to value, optional
        Parameters that are known and not searched.
    method : {"ga", "least-squares"}
    rest_speed : float [rad/s or m/s]
        A joint this slow is taken to be at rest, where friction is undetermined; its torque is left out.
    progress : callable, optional
    clock : callable

    Raises
    ------
    ConfigError
        If a name is not that of a base parameter, or bounds are the wrong way round.
    DataError
        If there is no trial or a trial has no torque.
    NotIdentifiable
        If the data tells no parameter.
    NotConverged
        If the generations were too few to find the optimum.
    """
    if not learn:
        raise DataError("no learning trial; expected at least one")
    start, base = clock(), structural_parameters(arm)
    sums = add_up([trial_sums(arm, base, trial, rest_speed) for trial in learn])
    fit = fit_sums(
        arm,
        base,
        sums,
        seed=seed,
        population=population,
        generations=generations,
        bounds=bounds,
        fixed=fixed,
        method=method,
        progress=progress,
    )
    return replace(fit, seconds=clock() - start)


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
    """Learn the base parameters from sums that may have come from anywhere; see `fit_dynamics`."""
    _check_names(base, bounds or {}, fixed or {})
    index = {name: k for k, name in enumerate(base.names)}
    prior = base.combination @ standard_parameters(arm)
    problem = torque_problem(sums, prior, {index[name]: value for name, value in (fixed or {}).items()})
    size = population or max(POPULATION, INDIVIDUALS_PER_GENE * len(problem.free))
    if method == "ga":
        lower, upper = _bounds(base, problem, bounds or {})
        genes = _search(problem, lower, upper, np.random.default_rng(seed), size, generations, progress)
    else:
        genes = problem.optimum()
    values = problem.complete(genes)
    parameters = fitted_parameters(
        base.names, values, problem.standard_errors(values), base.units, problem.revealed
    )
    learnt = {base.names[k]: Estimate(*astuple(parameters[base.names[k]])[:2]) for k in problem.free}
    calibrated = replace(with_base_values(arm, base, values), base_parameters=learnt)
    return DynamicsFit(
        arm=calibrated,
        parameters=parameters | _static_friction(arm),
        method=method,
        generations=generations if method == "ga" else 0,
        population=size if method == "ga" else 0,
        samples=sums.samples,
        seconds=0.0,
        condition_number=problem.condition_number,
        cost=float(problem.cost(genes[None])[0]),
    )


def document(fit: DynamicsFit, learn: Score, evaluate: Score | None = None) -> dict[str, object]:
    """Return the JSON document of ``fitter dynamics``.

    Parameters
    ----------
    fit : DynamicsFit
    learn, evaluate : Score
        Of the calibrated arm on the learning and, where there are any, the evaluating trials.
    """
    scores = {"learn": learn, "evaluate": evaluate}
    return {
        "parameters": {name: parameter.document() for name, parameter in fit.parameters.items()},
        "method": fit.method,
        "generations": fit.generations,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "condition_number": fit.condition_number,
        "torque_rms_N_m": {role: s and list(s.torque_rms_N_m) for role, s in scores.items()},
        "angle_error_deg": {
            role: s and {"mean": s.angle_mean_deg, "max": s.angle_max_deg} for role, s in scores.items()
        },
    }


def _check_names(base: BaseParameters, *named: Mapping[str, object]) -> None:
    unknown = sorted({name for names in named for name in names} - set(base.names))
    if unknown:
        raise ConfigError(
            f"no base parameter is called {', '.join(unknown)}; this arm has {', '.join(base.names)}"
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


def _search(
    problem: TorqueProblem,
    lower: Floats,
    upper: Floats,
    rng: np.random.Generator,
    population: int,
    generations: int,
    progress: Progress | None,
) -> Floats:
    algorithm = GeneticAlgorithm(lower, upper, rng, population)
    for _ in range(generations):
        algorithm.tell(problem.cost(algorithm.ask()))
        if progress is not None:
            progress(algorithm.generation, algorithm.best_cost)
    optimum = problem.optimum()
    excess = algorithm.best_cost - float(problem.cost(optimum[None])[0])
    allowed = _NOT_CONVERGED * problem.rest + 1e-9 * float(problem.z @ problem.z)
    if np.all((lower <= optimum) & (optimum <= upper)) and not excess <= allowed:
        raise NotConverged(
            f"after {generations} generations of {population} the cost {algorithm.best_cost:.6g} is still "
            f"{excess:.3g} above the optimum; expected no more than {allowed:.3g}, so give it more generations"
        )
    return algorithm.best


def _static_friction(arm: Arm) -> dict[str, FittedParameter]:
    return {
        f"F{i + 1}": FittedParameter(
            joint.friction.static_N_m, np.nan, "N m" if joint.type == "revolute" else "N", False
        )
        for i, joint in enumerate(arm.joints)
    }
