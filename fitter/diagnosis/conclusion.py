"""The verdict that follows from a search, and the finding: causes with their equals, arm, errors and gain."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from fitter.diagnosis.basis_functions import Discrepancy
from fitter.diagnosis.discrepancy import describe, surpassed
from fitter.diagnosis.disturbance_pulses import DisturbancePulses
from fitter.diagnosis.estimates import Estimates, estimates
from fitter.diagnosis.evidence import Floor
from fitter.diagnosis.extended_arm import extended_arm
from fitter.diagnosis.finding import Conclusion, Finding, NamedCause, Polished, ResidualSize, Tried
from fitter.diagnosis.held_out import judged, likeness, torque_residual
from fitter.diagnosis.held_out_error import NO_INTERVAL, Errors, gain
from fitter.diagnosis.model import Candidate, Hypothesis
from fitter.diagnosis.model_averaging import averaged
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.next_experiment import next_experiment
from fitter.diagnosis.payload import Payload
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.search import Search, StaticFriction, Verdict
from fitter.diagnosis.static_friction import EFFECT as STICTION
from fitter.diagnosis.static_friction import static_frictions, sticking, with_humps
from fitter.diagnosis.trial_clocks import begins_in, entries, trial_at
from fitter.dynamics.evaluation import HORIZON_S
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import of_source

_START = "start_s"
_NAMES = (_START, "duration_s", "torque_N_m")


def pushes_of(motions: Sequence[Motion], cause: NamedCause) -> list[NamedCause]:
    """Return a cause of several pushes as one cause each, with the trial that it is in.

    Parameters
    ----------
    motions : sequence of Motion
    cause : NamedCause
        Its starts are on the run's clock.
    """
    count, listed = len(cause.parameters) // len(_NAMES), []
    for k in range(1, count + 1):
        end = f"_{k}" if count > 1 else ""
        own = {name: cause.parameters[name + end] for name in _NAMES}
        motion = trial_at(motions, own[_START].value)
        own[_START] = replace(own[_START], value=own[_START].value - motion.ahead_s)
        listed.append(replace(cause, parameters=own, where={"trial": motion.trial.name}))
    return listed


def finding_of(
    regression: Regression,
    come_to: Conclusion,
    motions: Sequence[Motion],
    horizon_s: float = HORIZON_S,
    polish: Polished | None = None,
) -> Finding:
    """Return what was found, judged on the evaluating trials.

    Parameters
    ----------
    regression : Regression
    come_to : Conclusion
    motions : sequence of Motion
        All trials, not thinned.
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    polish : Polished, optional
        Of the model, if that was tried; the numbers are its own already where it was kept.
    """
    search, final, verdict, numbers = come_to.search, come_to.final, come_to.verdict, come_to.numbers
    plain = numbers if search.final is search.base else estimates(regression, search.base)
    base_arm = extended_arm(regression, search.base, plain)
    found = plain if final is search.base else numbers
    rivals = {}
    if final is not search.base:
        rivals = {id(one): estimates(regression, one) for cause in search.causes for one in cause.beside}
        found = averaged(search, found, rivals)
    extended = base_arm if final is search.base else extended_arm(regression, final, found)
    judging = [motion for motion in motions if not motion.learn]
    causes = [] if final is search.base else _causes(regression, search, found, rivals)
    suspected: list[tuple[str, tuple[int, ...]]] = []
    if verdict == "unexplained":
        suspected = [(one.kind.name, tuple(j + 1 for j in one.joints)) for one in search.final.model.hypotheses]
    if verdict in ("named", "ambiguous"):
        causes += _at_rest(regression, come_to)
        extended = sticking(extended, come_to.held)
    before = judged(regression, search.base, base_arm, judging, horizon_s)
    after = before if extended is base_arm else judged(regression, final, extended, judging, horizon_s)
    fall = gain(before, after)
    believed = final is not search.base or search.final is search.base
    effects = sorted({cause.effect for cause in causes})
    confusable = [] if final is search.base else _confusable(search)
    confusable += sorted({(STICTION, one.hypothesis.kind.name) for one in come_to.equals.values()})
    joints = [j for cause in causes for j in cause.joints]
    return Finding(
        verdict=verdict,
        complete=believed and not search.floor.is_large,
        residual_size=_residual_size(search.floor if believed else search.base_floor, before, after),
        causes=causes,
        candidates=_tried(regression, search, come_to.held),
        confusable=confusable,
        next_experiment=next_experiment(verdict, effects, joints, come_to.discrepancy.depends_on),
        before=before,
        after=after,
        gain=fall,
        discrepancy=come_to.discrepancy,
        structure=float(np.max(search.base_floor.ratio)) - 1.0,
        polish=polish,
        base_arm=base_arm,
        arm=extended,
        notes=[
            *([alike] if (alike := likeness(regression)) is not None else []),
            *([NO_INTERVAL] if fall.ci95 is None else []),
            *(note for motion in motions for note in of_source(motion.trial.notes, motion.trial.name)),
        ],
        suspected=suspected,
        torque_explained={
            role: _explained(regression, final, [motion for motion in motions if motion.learn is learning])
            for role, learning in (("learn", True), ("evaluate", False))
        },
    )


def _residual_size(floor: Floor, before: Errors, after: Errors) -> ResidualSize:
    was, remaining = (float(np.sqrt(np.sum(one.torque_rms**2))) for one in (before, after))
    noise = float(np.sqrt(np.max(floor.ratio)))
    return ResidualSize(
        after.torque_rms.tolist(), float(np.clip(remaining / was, 0.0, 1.0)) if was > 0.0 else 0.0, noise
    )


def _explained(regression: Regression, fitted: Candidate, motions: Sequence[Motion]) -> list[float]:
    """Return what a model explains of every joint's torque in some trials, see `Finding`."""
    residual_power, power = np.zeros((2, regression.arm.n_joint))
    for motion in motions:
        residual_power += np.nansum(torque_residual(regression, fitted, motion) ** 2, axis=0)
        power += np.nansum(np.where(motion.unknown, np.nan, motion.u) ** 2, axis=0)
    return [float(x) for x in 1.0 - residual_power / np.where(power > 0.0, power, np.nan)]


def _causes(
    regression: Regression, search: Search, found: Estimates, rivals: Mapping[int, Estimates]
) -> list[NamedCause]:
    """Return the accepted causes, each with those that explain as much in its stead right behind it."""
    motions = regression.motions
    learnt = [motion.learn for motion in motions]
    held_out = [not one for one in learnt]
    listed = []
    for cause in search.causes:
        taken = {"learn": cause.takes_away(learnt)}
        if any(held_out):
            taken["evaluate"] = cause.takes_away(held_out)
        hypothesis = search.final.model.hypotheses[cause.place]
        named = _named(motions, hypothesis, found.effects[cause.place], cause.support[0], taken)
        listed += pushes_of(motions, named) if isinstance(hypothesis, DisturbancePulses) else [named]
        for rival, share in zip(cause.beside, cause.support[1:], strict=True):
            own = rivals[id(rival)].effects[-1]
            listed.append(replace(_named(motions, rival.hypothesis, own, share, {}), in_stead=True))
    return listed


def _at_rest(regression: Regression, come_to: Conclusion) -> list[NamedCause]:
    """Return what holds joints, each with the hump that might as well right behind it."""
    listed = []
    for one in come_to.held:
        equal = come_to.equals.get(one.joint)
        share = 1.0 if equal is None else 0.5
        listed.append(NamedCause(STICTION, (one.joint + 1,), {"static_N_m": one.parameter}, share))
        if equal is not None:
            own = estimates(regression, equal).effects[-1]
            listed.append(replace(_named(regression.motions, equal.hypothesis, own, share, {}), in_stead=True))
    return listed


def _named(
    motions: Sequence[Motion],
    hypothesis: Hypothesis,
    numbers: dict[str, FittedParameter],
    support: float,
    takes_away: Mapping[str, float],
) -> NamedCause:
    where: dict[str, object] = {}
    if isinstance(hypothesis, Payload) and hypothesis.since_s is not None:
        since = numbers["since_s"]
        first = begins_in(motions, since.value)
        numbers = numbers | {"since_s": replace(since, value=since.value - first.ahead_s)}
        where = {"trial": first.trial.name}
    elif isinstance(hypothesis, Payload):
        called = entries(motions)
        where = {"trials": [called[number] for number in sorted(hypothesis.trials)]}
    joints = tuple(j + 1 for j in hypothesis.joints)
    return NamedCause(hypothesis.kind.name, joints, numbers, support, where, takes_away)


def _confusable(search: Search) -> list[tuple[str, str]]:
    pairs = {
        tuple(sorted((cause.itself.hypothesis.kind.name, other.hypothesis.kind.name)))
        for cause in search.causes
        for other in (*cause.rivals, *cause.larger)
    }
    return sorted((a, b) for a, b in pairs)


def _tried(regression: Regression, search: Search, held: Sequence[StaticFriction]) -> list[Tried]:
    """Return every hypothesis that was tried with the base model, by its gain on the evaluating trials."""
    held_out = np.array([not motion.learn for motion in regression.motions])
    was = max(float(search.screening_base.squares[held_out].sum()), np.finfo(np.float64).tiny)

    def tried(one: Candidate, support: float) -> Tried:
        joints = tuple(j + 1 for j in one.hypothesis.joints)
        gain = float(np.clip(1.0 - one.squares[held_out].sum() / was, 0.0, 1.0))
        return Tried(one.hypothesis.kind.name, joints, gain, support)

    options = zip(search.first, search.support, strict=True)
    listed = [tried(one, share if search.causes else 0.0) for one, share in options]
    listed += [tried(one, 0.0) for one in search.in_vain]
    listed += [Tried(STICTION, (one.joint + 1,), float(np.clip(one.gain, 0.0, 1.0)), 1.0) for one in held]
    return sorted(listed, key=lambda one: -one.gain)


def concluded(regression: Regression, search: Search) -> Conclusion:
    """Return what follows from a search.

    Parameters
    ----------
    regression : Regression
        Under the weights of the search's final model.
    search : Search
    """
    numbers = estimates(regression, search.final)
    held = static_frictions(regression, search.final, numbers.covariance)
    discrepancy = describe(regression, search.final, search.floor)
    verdict = _verdict(regression, search, discrepancy, bool(held))
    if verdict == "unexplained":
        of_base = describe(regression, search.base, search.base_floor) if search.causes else discrepancy
        return Conclusion(search, verdict, search.base, numbers, of_base, held, {})
    found, held, equals = with_humps(regression, search, held)
    if found is not search:
        numbers, discrepancy = estimates(regression, found.final), describe(regression, found.final, search.floor)
    return Conclusion(found, "ambiguous" if equals else verdict, found.final, numbers, discrepancy, held, equals)


def _verdict(regression: Regression, search: Search, discrepancy: Discrepancy, held: bool) -> Verdict:
    """Return the verdict.

    Causes are believed unless some unknown function of few variables, in their place, does clearly better:
    they then imitate what stands in no catalogue.
    """
    if search.final.model.hypotheses:
        if surpassed(regression, search.final):
            return "unexplained"
        return "ambiguous" if any(cause.rivals for cause in search.causes) else "named"
    if (search.floor.is_large and not discrepancy.white) or surpassed(regression, search.base):
        return "unexplained"
    return "named" if held else "none"
