"""An arm's numbers moved until its simulated motion is nearest to the measured one; kept if other trials gain."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats
from fitter.data.trials import Trial
from fitter.diagnosis.simulated_motion.braking import friction_at, seen_states
from fitter.diagnosis.simulated_motion.forward_error import ForwardError, forward_error
from fitter.diagnosis.simulated_motion.numbers import Numbers, numbers_of
from fitter.diagnosis.simulated_motion.shooting import ShootingWithEffects, windows
from fitter.diagnosis.simulated_motion.torque_error import torque_rms
from fitter.dynamics.output_error import Allowed, fit_motion
from fitter.dynamics.shooting import finest_needed
from fitter.dynamics.stretches import LONGEST_STEP_S, Stretch
from fitter.dynamics.structure import structural_parameters

#: A number without a standard error is felt if it moves by this share of itself, or of the largest of its unit.
_FELT, _FELT_OF_LARGEST = 1.0, 1e-2
#: Weight of a window's own noise where nothing pulls a simulation back: the sum of rms errors is made small.
_CHAOTIC = 0.5
#: Slopes of what friction adds up to, nearly linear, are taken over this share of a number's scale.
_LIMIT_STEP = 1e-4
#: A friction has at least this scale [N m or N]: less is none.
_LEAST_FRICTION = 1e-9


@dataclass(frozen=True)
class Scores:
    """What an arm gets wrong on some trials.

    Attributes
    ----------
    torque_rms : (n_joint,) [N m or N], or None
        None where nothing drove the arm.
    motion : ForwardError
    """

    torque_rms: Floats | None
    motion: ForwardError


@dataclass(frozen=True)
class Polish:
    """An arm whose numbers were moved by simulated motion.

    Attributes
    ----------
    arm : Arm
        The moved one if it is kept, else the one that came in.
    kept : bool
        Whether the evaluating trials' forward error (mean) fell.
    found : Arm
        The moved one in any case.
    values, std : mapping of str to float
        The numbers that were sought, and their standard errors; NaN where data are too few to say.
    converged : bool
    iterations : int
    learn, evaluate : (Scores, Scores)
        Before and after, of the moved arm whether it is kept or not.
    """

    arm: Arm
    kept: bool
    found: Arm
    values: Mapping[str, float]
    std: Mapping[str, float]
    converged: bool
    iterations: int
    learn: tuple[Scores, Scores]
    evaluate: tuple[Scores, Scores]


def polish(
    arm: Arm,
    learn: Sequence[Trial],
    evaluate: Sequence[Trial],
    sought: Sequence[str],
    horizon_s: float,
    std: Mapping[str, float] | None = None,
    prior_factor: float = np.inf,
    own_noise: float | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Polish:
    """Move some numbers of an arm by the learning trials' simulated motion; keep them if the evaluating ones gain.

    Parameters
    ----------
    arm : Arm
        With its effects.
    learn, evaluate : sequence of Trial
        On the run's clock.
    sought : sequence of str
        Base parameters by their names, friction among them, and effects' numbers such as
        ``effect[0].coulomb_N_m``. All others stay. Where nothing drives the arm, one of its masses must stay.
    horizon_s : float
        Length of the windows with measured torque or none, of the fit and of the forward error.
    std : mapping of str to float, optional
        Standard errors of the torque fit: what numbers are scaled by, and with ``prior_factor`` what is known of
        them.
    prior_factor : float
        By how much the prior's standard errors are larger than these; infinite for no prior.
    own_noise : float, optional
        By how much windows that fit worse count less, from 0 to 1; see `fitter.dynamics.output_error.fit_motion`.
        Unless given, the sum of squares is made small under a law, and with measured torque or none that of the
        windows' rms errors: a few in which motion is chaotic then have no more say than the others.
    progress : callable, optional
        Called after every iteration: how many are done, and the rms error in units of the noise.

    Raises
    ------
    ConfigError
        If there is no number of some name.
    """
    numbers = numbers_of(arm, structural_parameters(arm))
    free = numbers.sought(sought)
    shooting = ShootingWithEffects(numbers, len(learn))

    def complete(x: Floats) -> Floats:
        values = numbers.values
        values[free] = x
        return values

    def cut(step_s: float) -> list[Stretch]:
        return windows(arm, learn, step_s, horizon_s)

    x0, known = numbers.values[free], dict(std or {})
    scale = _scale(numbers, known)[free]
    errors = np.array([known.get(name, np.inf) for name in sought])
    low, high = (one[free] for one in numbers.bounds)
    allowed = Allowed(low, high, _brakes(numbers, shooting, learn, complete, x0, scale), prior_factor * errors)
    if own_noise is None:
        own_noise = _CHAOTIC if arm.control.law == "measured" else 0.0
    parts = cut(finest_needed(shooting, cut, numbers.values, LONGEST_STEP_S))
    fit = fit_motion(shooting, parts, complete, x0, scale, progress, allowed, own_noise)
    found = numbers.with_values(complete(fit.x))
    before, after = (
        [
            Scores(torque_rms(one, trials, first), forward_error(one, trials, horizon_s, first))
            for trials, first in ((learn, 1), (evaluate, 1 + len(learn)))
        ]
        for one in (arm, found)
    )
    kept = after[1].motion.total_mean < before[1].motion.total_mean
    return Polish(
        found if kept else arm,
        kept,
        found,
        dict(zip(sought, fit.x.tolist(), strict=True)),
        dict(zip(sought, np.sqrt(np.diag(fit.covariance)).tolist(), strict=True)),
        fit.converged,
        fit.iterations,
        (before[0], after[0]),
        (before[1], after[1]),
    )


def _scale(numbers: Numbers, std: Mapping[str, float]) -> Floats:
    """Return by how much each number would have to move to be felt, roughly."""
    size = np.abs(numbers.values)
    units = numbers.units
    largest = np.array([max(s for s, other in zip(size, units, strict=True) if other == unit) for unit in units])
    scale = np.maximum(_FELT * size, _FELT_OF_LARGEST * np.where(largest > 0.0, largest, 1.0))
    return scale


def _brakes(
    numbers: Numbers,
    shooting: ShootingWithEffects,
    trials: Sequence[Trial],
    complete: Callable[[Floats], Floats],
    x0: Floats,
    scale: Floats,
) -> Callable[[Floats], tuple[Floats, Floats]]:
    """Return what must not be negative: friction at the speeds that were seen, in units of its largest term."""
    states = seen_states(trials)
    moved = states[2].max(axis=0) > 0.0

    def total(x: Floats) -> tuple[Floats, Floats]:
        machine = shooting.machine(complete(x))
        return friction_at(machine.arm, machine.chain.friction, states)

    unit = np.maximum(total(x0)[1], _LEAST_FRICTION)

    def limits(x: Floats) -> tuple[Floats, Floats]:
        def g(at: Floats) -> Floats:
            return np.asarray((total(at)[0] / unit)[:, moved].ravel())

        here = g(x)
        return here, np.stack([(g(x + h) - here) / h.sum() for h in np.diag(_LIMIT_STEP * scale)], axis=1)

    return limits
