"""Whether anybody can act on a fit of the dynamics: what it explains, and whether an arm can have its numbers."""

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from arm.model import Arm, Floats
from fitter.data.standstill import REST_SPEED
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.evaluation import Score
from fitter.dynamics.torque_wiring import check_wiring
from fitter.regression_sums.trial_sums import moving_all_along
from limbcal.note import Note

#: Least explained fraction of the torque's power: below it the residual is 87 % of the torque's rms.
LEAST_EXPLAINED = 0.25
#: Least power that the best feasible arm explains, as a fraction of what unconstrained numbers explain.
LEAST_POSSIBLE = 0.5
#: An answer is believed if noise would explain as much with a probability below this.
_CHANCE = 1e-3


def unusable(fit: DynamicsFit, arm: Arm, learn: Sequence[Trial], scores: dict[str, Score | None]) -> list[str]:
    """Return why nobody can act on a fit, a sentence each; none where it can be used.

    Parameters
    ----------
    fit : DynamicsFit
    arm : Arm
        As it was given.
    learn : sequence of Trial
        What was learnt from.
    scores : dict of str to Score or None
        By role, ``learn`` and ``evaluate``.
    """
    reasons = []
    check = check_wiring(arm, fit.base, learn)
    if check is not None:
        if check.better is not None:
            reasons.append(check.better.sentence)
        elif 1.0 - check.possible < LEAST_POSSIBLE * (1.0 - check.free):
            reasons.append(
                "masses come out negative or otherwise impossible: the best arm that can exist explains "
                f"{percent(1.0 - check.possible)} of the torque, numbers that no arm can have "
                f"{percent(1.0 - check.free)}; {_suspects(arm)}"
            )
    reasons += _driving(arm)
    if not reasons:
        reasons += next_to_nothing(explained_of(scores), arm) or _by_chance(fit, learn, arm)
    return reasons


def _by_chance(fit: DynamicsFit, learn: Sequence[Trial], arm: Arm) -> list[str]:
    """Return a sentence where as many parameters would explain as much of noise.

    The F-test of all parameters together. Behind a filter a trial has two independent samples a period of its
    corner.
    """
    free, power = len(fit.problem.free), float(fit.problem.sums.power.sum())
    has_torque = fit.problem.sums.power.sum(axis=0) > 0.0
    independent = sum(trial.n_independent * float(_holding(trial)[has_torque].sum()) for trial in learn)
    if not power > 0.0 or fit.problem.rest <= 0.0:
        return []
    if independent <= free:
        return [
            f"the torque of the learning trials holds about {independent:.0f} independent samples of moving "
            f"joints behind the filter, too few for {free} parameters; expected longer or more trials, more "
            "motion, or a torque that is not cut off"
        ]
    explained, spare = max(0.0, 1.0 - fit.problem.rest / power), independent - free
    ratio = explained / free / ((1.0 - explained) / spare) if explained < 1.0 else np.inf
    if scipy.stats.f.sf(ratio, free, spare) < _CHANCE:
        return []
    return [
        f"{free} parameters explain {percent(explained)} of the torque of the learning trials, no more than they "
        f"would of noise ({independent:.0f} independent samples behind the filter): {_suspects(arm)}"
    ]


def _holding(trial: Trial) -> Floats:
    """Return during which share of a trial each joint's equation holds, (n_joint,): it moves, and is measured."""
    return np.asarray(moving_all_along(trial, slice(0, len(trial.q)), REST_SPEED).mean(axis=0), dtype=np.float64)


def explained_of(scores: Mapping[str, Score | None]) -> dict[str, Sequence[float]]:
    """Return which share of each joint's torque is explained, by role."""
    return {role: score.explained for role, score in scores.items() if score is not None}


def next_to_nothing(shares: Mapping[str, Sequence[float] | None], arm: Arm) -> list[str]:
    """Return a sentence for each role whose torque is hardly explained at all.

    Parameters
    ----------
    shares : mapping of str to (n_joint,)
        Which share of each joint's torque is explained, by role, ``learn`` and ``evaluate``.
    arm : Arm
    """
    reasons = []
    for role, title in (("learn", "learning"), ("evaluate", "evaluating")):
        if not shares.get(role):
            continue
        explained = np.array(shares[role], dtype=np.float64)  # None, of a joint without torque, is not known
        known = np.isfinite(explained)
        if known.any() and float(explained[known].max()) < LEAST_EXPLAINED:
            said = ", ".join(percent(float(share)) for share in explained[known])
            reasons.append(
                f"next to nothing of the torque of the {title} trials is explained ({said} a joint; expected at "
                f"least {percent(LEAST_EXPLAINED)}): {_suspects(arm)}"
            )
    return reasons


def joint_notes(scores: dict[str, Score | None]) -> tuple[Note, ...]:
    """Return a note for each joint whose torque in the learning trials is hardly explained."""
    score = scores.get("learn")
    if score is None:
        return ()
    return tuple(
        Note("unexplained", f"of tau{j + 1} only {percent(share)} is explained", columns=(f"tau{j + 1}",))
        for j, share in enumerate(score.explained)
        if np.isfinite(share) and share < LEAST_EXPLAINED
    )


def _driving(arm: Arm) -> list[str]:
    """Return a sentence where the law's damping gains drive the joints."""
    control = arm.control
    if control.law not in ("pd", "pda"):
        return []
    driving = [(j + 1, kv) for j, kv in enumerate(control.kv) if kv > 0.0]
    if not driving:
        return []
    said = ", ".join(f"kv{j} = {kv:g}" for j, kv in driving)
    frictions = ", ".join(f"D{j}" for j, _ in driving)
    return [
        f"{said} in [control] drives the joint: in tau = kp (ref - q) + kv dq a gain that damps is below zero; "
        f"with the wrong sign {frictions} comes out larger by twice the gain. Expected kv below zero"
    ]


def _suspects(arm: Arm) -> str:
    if arm.control.law == "measured":
        return "check the torque's columns, signs and unit, the angles' unit and zero, and gravity in the arm file"
    return "check the law and the signs of its gains in [control], the angles' unit and zero, and gravity"


def percent(share: float) -> str:
    """Return a share in words; below zero an arm without mass would do better, and there may be none at all."""
    if not np.isfinite(share):
        return "–"
    return f"{100.0 * share:.3g} %" if share > 0.0 else "nothing"
