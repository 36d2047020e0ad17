"""A model's numbers moved until its simulated motion is nearest to the measured one; kept if other trials gain.

The learning trials' angles move the numbers by multiple shooting (`fitter.dynamics.output_error`). Moved
numbers are kept only while the size of every cause differs significantly from none, as the search demands, too.

Where a torque was measured, the motion is evidence in addition to the torque's equations. These count as the
search weighs them; angles, which what the model lacks makes resemble each other, count once a block. Where none
was, the equations are the same angles, differentiated: they hold what simulated motion does not determine,
within a few of their standard errors. Numbers of what comes and goes stay: learning trials know nothing of what
others have.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.diagnosis.estimates import Estimates, estimates, information_of, significant
from fitter.diagnosis.extended_arm import ModelNumbers, extended_arm, given_effects, model_numbers
from fitter.diagnosis.finding import Conclusion, Polished
from fitter.diagnosis.held_out import aimed, judged, smooth, torque_residual
from fitter.diagnosis.held_out_error import Errors
from fitter.diagnosis.least_squares import BLOCK_S, EQUAL_SIGMAS, ROUNDED, SIGMAS, SLOPE
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.static_friction import sticking
from fitter.dynamics.braking import friction_at, seen_states
from fitter.dynamics.output_error import fit_motion
from fitter.dynamics.prior_and_limits import Allowed
from fitter.dynamics.shooting_effects import ShootingWithEffects, windows
from fitter.dynamics.shooting_windows import LONGEST_STEP_S


@dataclass(frozen=True)
class Polish:
    """A model whose numbers were moved by simulated motion.

    Attributes
    ----------
    said : Polished
        What it gained, and whether it is kept.
    candidate : Candidate
        The moved model, whether it is kept or not.
    numbers : Estimates
        Of that model; its standard errors are of the simulated motion.
    """

    said: Polished
    candidate: Candidate
    numbers: Estimates


def polished(
    regression: Regression, come_to: Conclusion, motions: Sequence[Motion], horizon_s: float
) -> Polish | None:
    """Move a model's numbers by the learning trials' simulated motion; None if there is nothing to move.

    That is where there are no causes, or where no more than the sensors' noise is left: the torque's equations
    then say all.

    Parameters
    ----------
    regression : Regression
    come_to : Conclusion
    motions : sequence of Motion
        All trials, not thinned.
    horizon_s : float
        Length of the windows with measured or no torque, of the fit and of the errors.
    """
    if come_to.final is come_to.search.base or come_to.search.floor.is_none:
        return None
    plain = sticking(extended_arm(regression, come_to.final, come_to.numbers), come_to.held)
    learning = [aimed(regression, come_to.final, one) for one in motions if one.learn]
    moved = _moved(regression, come_to, plain, learning, horizon_s)
    if moved is None:
        return None
    candidate, covariance = moved
    numbers = estimates(regression, candidate, covariance)
    arm = sticking(extended_arm(regression, candidate, numbers), come_to.held)
    others = [one for one in motions if not one.learn]
    before = judged(regression, come_to.final, plain, others, horizon_s)
    after = judged(regression, candidate, arm, others, horizon_s)
    is_significant = all(significant(candidate, covariance))
    kept = is_significant and comes_nearer(before, after)
    if kept and after.unfiltered_square is not None:
        kept = not loses(regression, come_to.final, candidate, others)
    return Polish(Polished(kept, before, after, is_significant), candidate, numbers)


def _moved(
    regression: Regression,
    come_to: Conclusion,
    arm: Arm,
    motions: Sequence[Motion],
    horizon_s: float,
    *,
    step_s: float = 2.0 * LONGEST_STEP_S,
    steps: int = 3,
    own_noise: float = 0.5,
) -> tuple[Candidate, Floats] | None:
    """Return the moved model, and its numbers' covariance; None if nothing moves or the arm runs away.

    Simulations go on by ``step_s``, Gauss and Newton's method by a few ``steps``, for the start is near. Where
    nothing pulls a simulation back, a window's ``own_noise`` has this weight: the sum of rms errors is made small.
    """
    kept = regression.equations.independent(
        regression.hypothetical(come_to.final.model, regression.motions[0]).arm
    )
    given = len(given_effects(regression.arm, come_to.final.model))
    numbers = model_numbers(arm, come_to.numbers, come_to.final, kept.tolist(), given)
    measured = is_measured(motions)
    torque = come_to.numbers.covariance
    free, basis = _white(numbers, torque, information_of(regression, come_to.final) if measured else None)
    width = np.sqrt(step_s / BLOCK_S) if measured else SIGMAS
    if not basis.shape[1]:
        return None

    def flat(z: Floats) -> Floats:
        values = numbers.start
        values[free] += basis @ z
        return values

    trials = [replace(one.trial, began_s=float(one.t[0] - one.trial.t[0])) for one in motions]
    shooting = ShootingWithEffects(numbers.numbers, len(trials), motions[0].number)
    n = basis.shape[1]
    limits = _limits(numbers, shooting, seen_states(trials), flat, n)
    fit = fit_motion(
        shooting,
        windows(arm, trials, step_s, horizon_s),
        lambda z: numbers.values(flat(z)),
        np.zeros(n),
        np.ones(n),
        None,
        Allowed(limits=limits, prior_std=np.full(n, width)),
        own_noise if arm.control.law == "measured" else 0.0,
        steps,
    )
    if not np.isfinite(fit.rms).all():
        return None
    covariance = torque.copy()
    if np.isfinite(fit.covariance).all():
        onto = np.linalg.pinv(basis) @ torque[np.ix_(free, free)] @ np.linalg.pinv(basis).T
        both = fit.covariance + fit.inverse @ onto @ fit.inverse / width**4
        covariance[free], covariance[:, free] = 0.0, 0.0
        found = basis @ both @ basis.T
        # What a limit holds has no scatter, and no known error.
        held = np.diag(found) <= ROUNDED * np.diag(torque)[free]
        found[held], found[:, held] = np.nan, np.nan
        covariance[np.ix_(free, free)] = found
    return numbers.at(flat(fit.x)), covariance


def is_measured(motions: Sequence[Motion]) -> bool:
    """Say whether the torque was measured: it is known neither by a law nor because there is none."""
    return all(one.trial.tau is not None for one in motions) and any(np.any(one.u) for one in motions)


def _white(numbers: ModelNumbers, covariance: Floats, known: Floats | None) -> tuple[NDArray[np.intp], Floats]:
    """Return which factors and psi are moved, (n,), and a basis (n, n_z) of them.

    In it the information that is given is that of one standard error each; unless it is, the covariance's inverse.
    """
    variance = np.diag(covariance)
    is_determined = np.isfinite(variance) & (variance > 0.0)
    if known is not None:  # such as a limit that only others reach
        is_determined &= np.diag(known) > 0.0
    free = np.flatnonzero(numbers.lasting & is_determined)
    square = np.ix_(free, free)
    unit = np.sqrt(variance[free]) if known is None else 1.0 / np.sqrt(np.diag(known)[free])
    matrix = covariance[square] / np.outer(unit, unit) if known is None else known[square] * np.outer(unit, unit)
    values, axes = np.linalg.eigh(matrix)
    kept = values > ROUNDED * values.max(initial=0.0)
    size = np.sqrt(values[kept]) if known is None else 1.0 / np.sqrt(values[kept])
    return free, unit[:, None] * axes[:, kept] * size


def _limits(
    numbers: ModelNumbers,
    shooting: ShootingWithEffects,
    states: Floats,
    flat: Callable[[Floats], Floats],
    n: int,
) -> Callable[[Floats], tuple[Floats, Floats]]:
    """Return what must not be negative: friction at the speeds that were seen, and what numbers may be, in units.

    Parameters
    ----------
    n : int
        How many coordinates there are.
    """
    moved = states[2].max(axis=0) > 0.0

    def total(z: Floats) -> tuple[Floats, Floats]:
        machine = shooting.machine(numbers.values(flat(z)))
        return friction_at(machine.arm, machine.chain.friction, states)

    here, steps = np.zeros(n), SLOPE * np.eye(n)
    unit = np.maximum(total(here)[1], ROUNDED)
    at_start = numbers.admitted(numbers.start)
    slopes = np.stack([numbers.admitted(flat(step)) - at_start for step in steps], axis=1) / SLOPE
    size = np.linalg.norm(slopes, axis=1)
    counts = np.isfinite(at_start) & (size > 0.0)

    def g(z: Floats) -> Floats:
        friction = (total(z)[0] / unit)[:, moved].ravel()
        return np.concatenate([friction, (numbers.admitted(flat(z))[counts]) / size[counts]])

    def limits(z: Floats) -> tuple[Floats, Floats]:
        now = g(z)
        return now, np.stack([(g(z + step) - now) / SLOPE for step in steps], axis=1)

    return limits


def comes_nearer(before: Errors, after: Errors) -> bool:
    """Say whether simulated motion comes nearer to the measured one, joints in units of their errors before."""
    was, became = before.motion_mean, after.motion_mean
    with np.errstate(invalid="ignore", divide="ignore"):
        return bool(np.mean(np.where(was == became, 1.0, became / was)) < 1.0)


def loses(regression: Regression, before: Candidate, after: Candidate, motions: Sequence[Motion]) -> bool:
    """Say whether the residual torque grows beyond the scatter of blocks, each joint in units of its own."""
    seen_hz, grows, was = regression.weighting.seen_hz, list[Floats](), list[Floats]()
    for motion in motions:
        residual = [
            smooth(torque_residual(regression, one, motion), motion.dt_s, seen_hz) for one in (before, after)
        ]
        squares = [np.nan_to_num(one) ** 2 for one in residual]
        parts = max(1, int(len(motion.t) * motion.dt_s / BLOCK_S))
        was += [part.sum(axis=0) for part in np.array_split(squares[0], parts)]
        grows += [part.sum(axis=0) for part in np.array_split(squares[1] - squares[0], parts)]
    unit = np.maximum(np.sum(was, axis=0), np.finfo(np.float64).tiny)
    growth = np.sum(np.array(grows) / unit, axis=1)
    scatter = np.sqrt(len(growth) / max(len(growth) - 1, 1) * np.sum((growth - growth.mean()) ** 2))
    return bool(growth.sum() > EQUAL_SIGMAS * scatter)
