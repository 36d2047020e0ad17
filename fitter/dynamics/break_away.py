"""Static friction from break-away: what friction held while a joint stood, and at what torque it let go.

Eq. (8) holds for moving joints, so static friction F is in no torque fit. But while a joint stands still, friction
alone takes up the load. F is at least every load that was held, and at most every one at which the joint let go
(`fitter.dynamics.stands`); each bound has the load's noise for its error (`fitter.dynamics.load_noise`), and all
share the errors of the arm's base parameters. F and its standard error are those of all bounds together
(`fitter.dynamics.friction_bounds`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Estimate, Floats
from arm.structural_parameters import structural_parameters
from fitter.data.trial import Trial
from fitter.dynamics.friction_bounds import Bound, between, contradict
from fitter.dynamics.load_noise import load_noise
from fitter.dynamics.stands import LEAST_STAND_S, has_torque, stands
from fitter.search.fitted_parameter import FittedParameter

#: What is proved stands out by this many standard errors: F from zero and from Coulomb friction, a load from
#: noise.
_PROVED = 3.0
#: What exceeds Coulomb friction by less than this fraction is no static friction of its own.
_ALIKE = 0.01


@dataclass(frozen=True)
class StaticFriction:
    """The static friction of one joint.

    Attributes
    ----------
    parameter : FittedParameter
        F [N m or N]; the arm's own where it is not identifiable.
    held, let_go : float
        Largest load that surely was held, 0 if none; smallest at which it surely let go, infinite if it never did.
    why : str
        How F was bracketed, or what is missing.
    """

    parameter: FittedParameter
    held: float
    let_go: float
    why: str


def static_friction(arm: Arm, trials: Sequence[Trial], covariance: Floats | None = None) -> list[StaticFriction]:
    """Return the static friction of every joint, where its break-away shows it.

    Parameters
    ----------
    arm : Arm
        A calibrated one: its masses say what gravity and the other joints put on a standing one, its law or the
        trials' torque what drives it, its Coulomb friction what F must exceed to be distinguished from it.
    trials : sequence of Trial
    covariance : (n_base, n_base), optional
        Of the arm's base parameters, zero where one is known. Default: from the standard errors that the arm has.

    Returns
    -------
    list of StaticFriction
        One a joint.
    """
    base = structural_parameters(arm)
    if covariance is None:
        std = np.array([arm.base_parameters.get(name, Estimate(0.0)).std for name in base.names])
        covariance = np.diag(np.nan_to_num(std) ** 2)
    return [_of_joint(arm, base, trials, i, covariance) for i in range(arm.n_joint)]


def _of_joint(
    arm: Arm, base: BaseParameters, trials: Sequence[Trial], i: int, covariance: Floats
) -> StaticFriction:
    joint, name = arm.joints[i], f"F{i + 1}"
    unit = "N m" if joint.type == "revolute" else "N"
    unknown = StaticFriction(FittedParameter(joint.friction.static_N_m, np.nan, unit, False), 0.0, np.inf, "")
    driven = [trial for trial in trials if has_torque(arm, trial)]
    if not driven:
        missing = "torque tau" if arm.control.law == "measured" else "target ref"
        return replace(unknown, why=f"{name} needs the {missing}{i + 1} of the trials")
    noise = load_noise(arm, driven, i)
    found = [stand for trial in driven for stand in stands(arm, base, trial, i, noise)]
    if not found:
        why = f"joint {i + 1} never stood still for {LEAST_STAND_S:g} s; {name} needs it to stick, then to let go"
        return replace(unknown, why=why)
    if not np.all(np.isfinite(covariance)):
        why = f"{name} needs the errors of the base parameters, and the trials are too short to tell these"
        return replace(unknown, why=why)
    lower = [stand.held for stand in found if stand.held is not None]
    upper = [stand.let_go for stand in found if stand.let_go is not None]
    return _judged(arm, i, unknown, lower, upper, covariance)


def _judged(
    arm: Arm,
    i: int,
    unknown: StaticFriction,
    lower: Sequence[Bound],
    upper: Sequence[Bound],
    covariance: Floats,
) -> StaticFriction:
    """Return what all bounds of a joint together say."""
    name, unit, coulomb = f"F{i + 1}", unknown.parameter.unit, max(arm.joints[i].friction.coulomb_N_m, 0.0)
    held = max([0.0, *(bound.value - _PROVED * bound.error(covariance) for bound in lower)])
    let_go = min([np.inf, *(bound.value + _PROVED * bound.error(covariance) for bound in upper)])
    unknown = replace(unknown, held=held, let_go=let_go)
    if not upper:
        why = f"joint {i + 1} held up to {held:.3g} {unit} and never let go: {name} is at least that"
        if not held:
            why = f"joint {i + 1} never let go while it was pulled at: nothing is known of {name}"
        return replace(unknown, why=why)
    said = f"joint {i + 1} held {held:.3g} {unit} and let go at {let_go:.3g} {unit}"
    value, std = between(lower, upper, covariance) if lower else (0.0, np.inf)
    if value < _PROVED * std:
        why = f"{said}: too wide a bracket for {name}; a target or torque that rises slowly would narrow it"
    elif held <= coulomb * (1.0 + _ALIKE) + _PROVED * _coulomb_std(arm, i):
        why = f"{said}, and Coulomb friction is {coulomb:.3g} {unit}: no static friction above it is proved"
    elif contradict(lower, upper, covariance, _PROVED):
        why = f"{said}: no friction does both, so {name} is not identifiable; one that creeps looks as if it stood"
    else:
        parameter = FittedParameter(value, std, unit, True)
        return replace(unknown, parameter=parameter, why=f"{said}: {name} lies between")
    return replace(unknown, why=why)


def _coulomb_std(arm: Arm, i: int) -> float:
    std = arm.base_parameters.get(f"fc{i + 1}", Estimate(0.0)).std
    return float(std) if np.isfinite(std) else 0.0
