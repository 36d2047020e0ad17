"""Dynamic parameters from motion and torque: eq. (4), (8) and (9)."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.standstill import REST_SPEED
from fitter.data.torque_target import has_unknown_target
from fitter.data.trial import Trial
from fitter.dynamics.band_agreement import frequencies_agree
from fitter.dynamics.break_away import static_friction
from fitter.dynamics.consistency import made_possible, with_warnings
from fitter.dynamics.dynamics_fit import DynamicsFit, Method, Objective
from fitter.dynamics.errors_of_motions import with_covariance, with_errors_of_motions
from fitter.dynamics.evaluation import HORIZON_S
from fitter.dynamics.filter_shift import with_filter_shift
from fitter.dynamics.known_effects import with_effects_of, without_effects
from fitter.dynamics.motion_search import polished_by_motion
from fitter.dynamics.noise_spectrum import noise_freedom, weighted_by_noise
from fitter.dynamics.robust import draw_in, weighted
from fitter.dynamics.torque_problem import torque_problem
from fitter.dynamics.torque_search import GENERATIONS, Progress, fit_sums
from fitter.regression_sums.spectral_sums import spectral_sums
from fitter.regression_sums.torque_sums import TorqueSums, add_up
from fitter.regression_sums.trial_sums import trial_sums
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note

#: Outliers are drawn in until no parameter moves by more than this fraction of its standard error.
_SETTLED = 1e-3
_ROUNDS = 200
DISAGREE = Note(
    "misfit",
    "low and high frequencies say different things of the arm, by more than their standard errors allow: the "
    "angles are noisy, or the arm has more in it than the model; eq. (9) is less sensitive to that than the "
    "likelihood, and true errors may be larger than the stated ones",
)
TOO_FEW = Note(
    "short",
    "of one joint's torque so little counts that its parameters explain all of it: its noise is not known, and "
    "the likelihood cannot weigh it; expected more motion of that joint with its torque measured, or eq. (9)",
)


def fit_dynamics(
    arm: Arm,
    learn: Sequence[Trial],
    *,
    objective: Objective | None = None,
    seed: int | np.random.Generator = 0,
    population: int | None = None,
    generations: int = GENERATIONS,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    method: Method = "ga",
    rest_speed: float = REST_SPEED,
    window_s: float = HORIZON_S,
    physical: bool = False,
    examine: bool = True,
    geometries: Floats | None = None,
    progress: Progress | None = None,
    polishing: Progress | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> DynamicsFit:
    """Learn the base parameters of an arm from some trials.

    Parameters
    ----------
    arm : Arm
        Its geometry, gravity and control law; its own dynamics are the prior of what the data cannot determine.
        What its effects do is known and taken out of the torque (`fitter.dynamics.known_effects`).
    learn : sequence of Trial
    objective : {"torque", "likelihood", "weighted", "robust", "motion"}, optional
        What is made small: eq. (9) as it is printed; with each frequency in units of its noise; with each joint in
        units of its noise; with outliers drawn in as well (Huber); or the difference between simulated and
        measured motion, after a fit of the torque. Default: `usual_objective`.
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
        A joint this slow is taken to be at rest, where friction is undetermined; its torque is omitted.
    window_s : float
        With the objective "motion" and measured torque: how long a simulation runs before it starts anew.
    physical : bool
        Whether the answer must be one that masses can have, with friction that brakes.
    examine : bool
        Whether to look for what no masses can have and for static friction, too: not while more motion comes in.
    geometries : (n_draw, n_joint, 5), optional
        The arm's geometry as it may be, where the trials have draws, too; without it the arm's is exact.
    progress, polishing : callable, optional
        Called after every generation, and every iteration of a fit of the motion: how many are done, and the cost.
    clock : callable

    Raises
    ------
    ConfigError
        If a name is not that of a base parameter, bounds are the wrong way round, or an effect of the arm cannot
        be taken out.
    DataError
        If there is no trial or a trial has no torque.
    NotIdentifiable
        If the data determines no parameter.
    NotConverged
        If the generations were too few to find the optimum.
    """
    if not learn:
        raise DataError("no learning trial; expected at least one")
    start, given = clock(), arm
    chosen, objective = objective is not None, objective or usual_objective(arm, learn)
    arm, learn = without_effects(arm, learn, objective)
    base = structural_parameters(arm)
    notes: tuple[Note, ...] = ()
    freedom = np.inf
    if objective == "likelihood":
        sums, notes, freedom = _by_noise(arm, base, learn, fixed or {}, rest_speed)
        if notes and not chosen:
            objective = "torque"
    if objective != "likelihood":
        sums = _plain(arm, base, learn, fixed or {}, rest_speed, objective == "motion")
    if objective in ("weighted", "robust"):
        sums, notes = _reweighted(arm, base, learn, sums, fixed or {}, objective, rest_speed)
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
    if objective == "likelihood":
        fit = with_covariance(fit, fit.covariance if freedom >= 1.0 else np.nan * fit.covariance, freedom)
    if objective == "motion":
        fit = polished_by_motion(fit, learn, window_s, polishing)
    else:
        fit = replace(fit, objective=objective, notes=(*notes, *fit.notes))
    if notes == (DISAGREE,) and objective == "torque":
        fit = with_filter_shift(fit, arm, learn, fixed or {}, rest_speed)
    if objective not in ("likelihood", "motion"):
        fit = with_errors_of_motions(fit, arm, learn, geometries, rest_speed)
    if physical or examine:
        fit = made_possible(fit) if physical else with_warnings(fit)
    if examine:
        fit = with_break_away(fit, learn)
    return replace(fit, arm=with_effects_of(given, fit.arm), seconds=clock() - start)


def usual_objective(arm: Arm, trials: Sequence[Trial]) -> Objective:
    """Return what is made small where nobody says it, if nothing speaks against it.

    The simulated motion where a law drives the arm and angles alone were measured; else the torque, weighted by
    its noise. A tracker's motion has errors that are no noise of the torque, and an unknown target is an unknown
    torque: for these eq. (9) as it is printed. So, too, where frequencies contradict the likelihood's assumptions
    (`fitter.dynamics.band_agreement`).
    """
    law = arm.control.law != "measured"
    if law and all(trial.whole for trial in trials):
        return "motion"
    plain = law and (any(has_unknown_target(arm, trial) or np.isinf(trial.band_hz) for trial in trials))
    return "torque" if plain else "likelihood"


def _plain(
    arm: Arm,
    base: BaseParameters,
    learn: Sequence[Trial],
    fixed: Mapping[str, float],
    rest_speed: float,
    begins: bool,
) -> TorqueSums:
    """Return the sums of eq. (9).

    Where joints turn back so often that no equation holds behind its filter, a fit of the motion ``begins`` with
    the likelihood, whose filter is as wide as the noise lets it be.
    """
    sums = add_up([trial_sums(arm, base, trial, rest_speed) for trial in learn])
    return _by_noise(arm, base, learn, fixed, rest_speed)[0] if begins and not np.any(sums.gram) else sums


def _by_noise(
    arm: Arm, base: BaseParameters, trials: Sequence[Trial], fixed: Mapping[str, float], rest_speed: float
) -> tuple[TorqueSums, tuple[Note, ...], float]:
    """Return sums with every frequency of each joint in units of its noise, what speaks against them, and freedom.

    The last is from how many degrees of freedom a joint's noise is known at the least.
    """
    if any(has_unknown_target(arm, trial) for trial in trials):
        raise ConfigError("the objective likelihood needs the controller's target; expected columns ref1…")
    prior = base.combination @ standard_parameters(arm)
    held = {base.names.index(name): value for name, value in fixed.items() if name in base.names}
    spectral = spectral_sums(arm, base, trials, rest_speed)
    sums = weighted_by_noise(spectral, prior, held)
    freedom = noise_freedom(spectral, sums, prior, held)
    if freedom < 1.0:
        return sums, (TOO_FEW,), freedom
    return sums, () if frequencies_agree(spectral, sums, prior, held) else (DISAGREE,), freedom


def with_break_away(fit: DynamicsFit, trials: Sequence[Trial]) -> DynamicsFit:
    """Return a fit with the static frictions that its trials show, and what they lack to show them."""
    free = fit.problem.free
    covariance = np.zeros((len(fit.base.names), len(fit.base.names)))
    covariance[np.ix_(free, free)] = fit.covariance
    found = static_friction(fit.arm, trials, covariance)
    joints = tuple(
        replace(joint, friction=replace(joint.friction, static_N_m=one.parameter.value))
        for joint, one in zip(fit.arm.joints, found, strict=True)
    )
    learnt = {f"F{i + 1}": one.parameter for i, one in enumerate(found)}
    notes = (*fit.notes, *(Note("static_friction", one.why) for one in found))
    return replace(fit, arm=replace(fit.arm, joints=joints), parameters={**fit.parameters, **learnt}, notes=notes)


def _reweighted(
    arm: Arm,
    base: BaseParameters,
    trials: Sequence[Trial],
    sums: TorqueSums,
    fixed: Mapping[str, float],
    objective: Objective,
    rest_speed: float,
) -> tuple[TorqueSums, tuple[Note, ...]]:
    """Return sums with joints in units of their noise and, if asked for, outliers drawn in."""
    prior = base.combination @ standard_parameters(arm)
    held = {base.names.index(name): value for name, value in fixed.items() if name in base.names}
    problem = torque_problem(sums, prior, held)
    values = problem.complete(problem.optimum())
    if objective == "weighted":
        return weighted(sums, values), ()
    for _ in range(_ROUNDS):
        pseudo = draw_in(arm, base, trials, values, rest_speed)
        problem = torque_problem(pseudo.sums, prior, held)
        before, values = values, problem.complete(problem.optimum())
        std = problem.standard_errors(values)[problem.free]
        if np.all(np.abs(values - before)[problem.free] <= _SETTLED * std):
            break
    share = ", ".join(f"{100 * bent:.2g} %" for bent in pseudo.bent)
    said = f"outlying torques drawn in: {share} of the samples a joint"
    return pseudo.sums, (Note("outliers", said),)
