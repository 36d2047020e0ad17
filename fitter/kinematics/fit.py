"""The arm's geometry from joint angles and the tip's displacement: eq. (1) to (3), by the genetic algorithm."""

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from arm.model import Arm
from fitter.data.first_rest import displacement
from fitter.data.trials import Trial
from fitter.kinematics.evaluation import TipScore
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.tip_basis import UNITS, geometry_names, with_geometry
from fitter.search.fitted_parameter import FittedParameter, fitted_parameters
from limbcal.errors import DataError, NotConverged, NotIdentifiable

GENERATIONS = 500
#: The search has ended too soon if a Gauss-Newton step still promises to lower the cost by this share.
_NOT_CONVERGED = 1e-3


@dataclass(frozen=True)
class KinematicsFit:
    """What was learnt of an arm's geometry.

    Attributes
    ----------
    arm : Arm
        The arm with the learnt geometry.
    parameters : mapping from name to FittedParameter
        alpha1, a1, d1, beta1, theta_offset1, alpha2, …
    generations, population, samples : int
    seconds : float
    tip_rms_m : float
        What the fit leaves of the tip's displacement.
    """

    arm: Arm
    parameters: Mapping[str, FittedParameter]
    generations: int
    population: int
    samples: int
    seconds: float
    tip_rms_m: float


def fit_kinematics(
    arm: Arm,
    learn: Sequence[Trial],
    *,
    seed: int | np.random.Generator = 0,
    population: int | None = None,
    generations: int = GENERATIONS,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    free: Collection[str] = (),
    about: Literal["rest", "mean"] = "rest",
    progress: Callable[[int, float], None] | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> KinematicsFit:
    """Learn the geometry of an arm from trials with a measured tip.

    Parameters
    ----------
    arm : Arm
        Its geometry is the prior of what the data can't tell.
    learn : sequence of Trial
        With a tip; what counts is its displacement within each trial.
    seed : int or numpy.random.Generator
    population : int, optional
    generations : int
    bounds, fixed, free
        See `IncrementalKinematics`, as for the default population.
    about : {"rest", "mean"}
        What displacements are counted from. "rest", the start of the trial, suits dead reckoning, whose error
        is zero there; "mean", their mean over the trial, suits samples that are measured one by one.
    progress : callable, optional
        Told after every generation: how many are done, and the rms error of the best [m].
    clock : callable

    Raises
    ------
    ConfigError
        If a parameter is unknown or its bounds are the wrong way round.
    DataError
        If there is no trial, or one has no tip.
    NotIdentifiable
        If nothing can be told.
    NotConverged
        If the generations were too few.
    """
    if not learn:
        raise DataError("no learning trial; expected at least one")
    start = clock()
    search = IncrementalKinematics(arm, seed, population=population, bounds=bounds, fixed=fixed, free=free)
    for number, trial in enumerate(learn):
        moved, rest = displacement(arm, trial)
        search.add(trial.q, moved, rest if about == "rest" else None, trial=number)
    for _ in range(generations):
        rms = search.generation()
        if progress is not None:
            progress(search.generations, rms)
    fit = fit_of(search)
    promise = search.promise()
    if not promise <= _NOT_CONVERGED:
        raise NotConverged(
            f"after {generations} generations of {search.population} one more step would still lower the cost by "
            f"{100 * promise:.3g} %; expected less than {100 * _NOT_CONVERGED:g} %, so give it more generations"
        )
    return replace(fit, seconds=clock() - start)


def fit_of(search: IncrementalKinematics) -> KinematicsFit:
    """Return what a search has found so far, with standard errors.

    Raises
    ------
    NotIdentifiable
        If nothing can be told yet.
    """
    if not np.any(search.told):
        raise NotIdentifiable(
            f"no geometric parameter can be told from {search.samples} samples: the tip or the joints don't move"
        )
    return KinematicsFit(
        arm=with_geometry(search.arm, search.best),
        parameters=fitted_parameters(
            geometry_names(search.arm.n_joint),
            search.best.ravel(),
            search.standard_errors().ravel(),
            UNITS * search.arm.n_joint,
            search.told.ravel(),
        ),
        generations=search.generations,
        population=search.population,
        samples=search.samples,
        seconds=0.0,
        tip_rms_m=search.tip_rms_m,
    )


def document(fit: KinematicsFit, learn: TipScore, evaluate: TipScore | None = None) -> dict[str, object]:
    """Return the JSON document of ``fitter kinematics``."""
    scores = {"learn": learn, "evaluate": evaluate}
    return {
        "parameters": {name: parameter.document() for name, parameter in fit.parameters.items()},
        "method": "ga",
        "generations": fit.generations,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "tip_error_mm": {role: s and {"mean": s.mean_mm, "max": s.max_mm} for role, s in scores.items()},
        "angle_noise_deg": [None] * fit.arm.n_joint,
    }
