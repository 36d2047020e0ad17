"""The arm's geometry from joint angles and the tip's displacement: eq. (1) to (3), by the genetic algorithm."""

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from arm.model import Arm
from fitter.data.trial import Trial
from fitter.kinematics.angle_noise import fit_from_moments, noise_from_moments, resolved_noise
from fitter.kinematics.found_geometry import fit_of, parameters_of, require_determined
from fitter.kinematics.incremental import IncrementalKinematics
from fitter.kinematics.kinematics_fit import KinematicsFit
from fitter.kinematics.moment_fit import MomentFit, MomentProblem, enough
from fitter.kinematics.origin import About, choose_about, counted_from_rest
from fitter.kinematics.tip_basis import expect_chain, turning, with_geometry
from limbcal.errors import DataError, NotConverged, NotIdentifiable

GENERATIONS = 500
#: Least explained fraction of the tip's displacement's power: below it the residual is 87 % of its rms.
LEAST_EXPLAINED = 0.25
#: The search has ended too soon if a Gauss-Newton step still promises to lower the cost by this fraction.
_NOT_CONVERGED = 1e-3


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
    about: Literal["auto"] | About = "auto",
    angle_noise: Literal["auto"] | None | Sequence[float] = "auto",
    progress: Callable[[int, float], None] | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> KinematicsFit:
    """Learn the geometry of an arm from trials with a measured tip.

    Parameters
    ----------
    arm : Arm
        Its geometry is the prior where the data do not determine it.
    learn : sequence of Trial
        With a tip; what counts is its displacement within each trial.
    seed : int or numpy.random.Generator
    population : int, optional
    generations : int
    bounds, fixed, free
        See `IncrementalKinematics`, as for the default population.
    about : {"auto", "rest", "mean"}
        What displacements are counted from. "rest", the start of the trial, suits dead reckoning, whose error
        is zero there; "mean", their mean over the trial, suits samples that are measured one by one. "auto":
        see `fitter.kinematics.origin.choose_about`.
    angle_noise : "auto", None or (n_joint,) [rad, or m where a joint slides]
        Standard deviation of white Gaussian noise in the angles, which is undone. None: there is none. "auto":
        from their spectra, or from the moments of independent samples.
    progress : callable, optional
        Called after every generation: how many are done, and the rms error of the best [m].
    clock : callable

    Raises
    ------
    ConfigError
        If a parameter is unknown or its bounds are the wrong way round.
    DataError
        If there is no trial, or one has no tip.
    NotIdentifiable
        If nothing is identifiable.
    NotConverged
        If the generations were too few.
    """
    if not learn:
        raise DataError("no learning trial; expected at least one")
    expect_chain(arm)
    start = clock()
    noise = resolved_noise(arm, learn, angle_noise)
    about = choose_about(learn, noise.rad) if about == "auto" else about

    def searched() -> IncrementalKinematics:
        search = IncrementalKinematics(
            arm, seed, population=population, bounds=bounds, fixed=fixed, free=free, angle_noise=noise.undone
        )
        for number, trial in enumerate(learn):
            moved, rest = counted_from_rest(arm, trial, np.zeros(1) if noise.undone is None else noise.undone)
            search.add(trial.q, moved, rest if about == "rest" else None, trial=number)
        _breed(search, generations, progress, _spread_m(learn))
        return search

    search, fit = searched(), None
    samples = search.samples
    if about == "mean" and enough(turning(arm), samples) and (noise.rad is None or noise.undone is not None):
        problem = MomentProblem(turning(arm), learn)
        estimated = np.zeros(arm.n_joint, dtype=bool)
        if noise.rad is None:
            noise, estimated = noise_from_moments(search, problem, _spread_m(learn))
            search = search if noise.undone is None else searched()
        if noise.undone is not None or np.any(estimated):
            fit = fit_from_moments(search, problem, noise, estimated)
            noise = replace(noise, rad=np.sqrt(np.maximum(fit.variance, 0.0)))
    if fit is None:
        search.polish()
    found = replace(fit_of(search, learn), about=about, angle_noise_rad=noise.rad, angle_noise_source=noise.source)
    return replace(found if fit is None else _by_moments(found, search, fit), seconds=clock() - start)


def _breed(
    search: IncrementalKinematics, generations: int, progress: Callable[[int, float], None] | None, spread_m: float
) -> None:
    """Let a search run.

    Raises
    ------
    NotIdentifiable
        If nothing is identifiable.
    NotConverged
        If the generations were too few.
    """
    for _ in range(generations):
        rms = search.generation()
        if progress is not None:
            progress(search.generations, rms)
    require_determined(search)
    promise = search.promise()
    explained = 1.0 - (search.tip_rms_m / spread_m) ** 2 if spread_m > 0.0 else 0.0
    if not promise <= _NOT_CONVERGED and explained < LEAST_EXPLAINED:
        raise NotIdentifiable(f"{search.generations} generations found no arm that moves so: {hardly(explained)}")
    if not promise <= _NOT_CONVERGED:
        raise NotConverged(
            f"after {generations} generations of {search.population} one more step would still lower the cost by "
            f"{100 * promise:.3g} %; expected less than {100 * _NOT_CONVERGED:g} %, so give it more generations"
        )


def hardly(explained: float) -> str:
    """Return a sentence for a tip whose displacement is hardly explained by the angles."""
    share = f"{100.0 * explained:.3g} %" if explained > 0.0 else "nothing"
    return (
        f"next to nothing of the tip's displacement is explained ({share}; expected at least "
        f"{100.0 * LEAST_EXPLAINED:.3g} %): check the units of q and of the tip, whether both are of the same "
        "trial and clock, which way joints turn, and the arm's alpha and joint types"
    )


def _spread_m(trials: Sequence[Trial]) -> float:
    tips = [np.asarray(trial.tip) - np.mean(np.asarray(trial.tip), axis=0) for trial in trials]
    return float(np.sqrt(np.mean(np.concatenate(tips) ** 2) * 3.0))


def _by_moments(found: KinematicsFit, search: IncrementalKinematics, fit: MomentFit) -> KinematicsFit:
    """Return what was found with the answer of the method of moments in the place of the search's."""
    std = np.full(fit.geometry.size, np.nan)
    std[search.sought] = np.sqrt(np.diag(fit.covariance))
    return replace(
        found,
        arm=with_geometry(search.arm, fit.geometry),
        parameters=parameters_of(search, fit.geometry, std),
        notes=(),
        tip_rms_m=float(np.sqrt(3.0) * fit.tip_noise_m),
    )
