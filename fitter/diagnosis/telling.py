"""What a search has come to, as a finding: causes with their equals, all candidates, the arm, errors and gain."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Arm, Effect, Floats
from fitter.diagnosis.conclusion import Conclusion
from fitter.diagnosis.estimates import Estimates, estimates, extended_arm
from fitter.diagnosis.finding import Finding, NamedCause, Tried
from fitter.diagnosis.holding import Holding
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.in_arm import Payload
from fitter.diagnosis.judgement import gain, judged, torque_left
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.next_experiment import next_experiment
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate
from fitter.diagnosis.search import Search
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import of_source


def finding_of(regression: Regression, come_to: Conclusion, motions: Sequence[Motion]) -> Finding:
    """Return what was found, judged on the evaluating trials.

    Parameters
    ----------
    regression : Regression
    come_to : Conclusion
    motions : sequence of Motion
        All trials, not thinned.
    """
    search, final, verdict, numbers = come_to.search, come_to.final, come_to.verdict, come_to.numbers
    plain = numbers if search.final is search.base else estimates(regression, search.base)
    base_arm = extended_arm(regression, search.base, plain)
    found = plain if final is search.base else numbers
    extended = base_arm if final is search.base else extended_arm(regression, final, found)
    judging = [motion for motion in motions if not motion.learn]
    causes = [] if final is search.base else _causes(regression, search, found)
    suspected: list[tuple[str, tuple[int, ...]]] = []
    if verdict == "unexplained":
        suspected = [(one.kind.name, tuple(j + 1 for j in one.joints)) for one in search.final.model.hypotheses]
    if verdict in ("named", "ambiguous"):
        causes += _at_rest(regression, come_to)
        extended = _sticking(extended, come_to.held)
    before = judged(regression, search.base, base_arm, judging)
    after = before if extended is base_arm else judged(regression, final, extended, judging)
    alike = sorted({cause.effect for cause in causes})
    confusable = [] if final is search.base else _confusable(search)
    confusable += [("stiction", "stribeck")] if come_to.equals else []
    joints = [j for cause in causes for j in cause.joints]
    return Finding(
        verdict=verdict,
        causes=causes,
        candidates=_tried(regression, search, come_to.held),
        confusable=confusable,
        next_experiment=next_experiment(verdict, alike, joints, come_to.remainder.depends_on),
        before=before,
        after=after,
        gain=gain(before, after),
        remainder=come_to.remainder,
        structure=search.structure,
        explained=search.explained,
        base_arm=base_arm,
        arm=extended,
        notes=[note for motion in motions for note in of_source(motion.trial.notes, motion.trial.name)],
        suspected=suspected,
        torque_explained={
            role: _explained(regression, final, [motion for motion in motions if motion.learn is learning])
            for role, learning in (("learn", True), ("evaluate", False))
        },
    )


def _explained(regression: Regression, fitted: Candidate, motions: Sequence[Motion]) -> list[float]:
    """Return what a model explains of every joint's torque in some trials, see `Finding`."""
    left, power = np.zeros((2, regression.arm.n_joint))
    for motion in motions:
        left += np.nansum(torque_left(regression, fitted, motion) ** 2, axis=0)
        power += np.nansum(np.where(motion.stuck, np.nan, motion.u) ** 2, axis=0)
    return [float(x) for x in 1.0 - left / np.where(power > 0.0, power, np.nan)]


def _causes(regression: Regression, search: Search, found: Estimates) -> list[NamedCause]:
    """Return the accepted causes, each with those that explain as much in its stead right behind it."""
    listed = []
    inflation = max(1.0, float(search.final.squares.sum() / search.told.sum()))
    for cause in search.causes:
        odds = [float(np.exp(-_worse(search, rival) / (2.0 * inflation))) for rival in cause.rivals]
        share = 1.0 / (1.0 + sum(odds))
        hypothesis = search.final.model.hypotheses[cause.place]
        listed.append(_named(hypothesis, found.effects[cause.place], share))
        for rival, odd in zip(cause.rivals, odds, strict=True):
            numbers = estimates(regression, rival).effects[-1]
            listed.append(_named(rival.hypothesis, numbers, odd * share))
    return listed


def _at_rest(regression: Regression, come_to: Conclusion) -> list[NamedCause]:
    """Return what holds joints, each with the hump that might as well right behind it."""
    listed = []
    for one in come_to.held:
        equal = come_to.equals.get(one.joint)
        share = 1.0 if equal is None else 0.5
        listed.append(NamedCause("stiction", (one.joint + 1,), {"static_N_m": one.parameter}, share))
        if equal is not None:
            listed.append(_named(equal.hypothesis, estimates(regression, equal).effects[-1], share))
    return listed


def _worse(search: Search, rival: Candidate) -> float:
    return max(0.0, float(rival.squares.sum() - search.final.squares.sum()))


def _named(hypothesis: Hypothesis, numbers: dict[str, FittedParameter], support: float) -> NamedCause:
    where: dict[str, object] = {}
    if isinstance(hypothesis, Payload):
        where = (
            {"since_s": hypothesis.since_s}
            if hypothesis.since_s is not None
            else {"trials": sorted(hypothesis.trials)}
        )
    joints = tuple(j + 1 for j in hypothesis.joints)
    return NamedCause(hypothesis.kind.name, joints, numbers, support, where)


def _confusable(search: Search) -> list[tuple[str, str]]:
    pairs = {
        tuple(sorted((search.final.model.hypotheses[cause.place].kind.name, rival.hypothesis.kind.name)))
        for cause in search.causes
        for rival in cause.rivals
    }
    return sorted((a, b) for a, b in pairs)


def _tried(regression: Regression, search: Search, held: Sequence[Holding]) -> list[Tried]:
    """Return every hypothesis that was tried beside the base model, by what it gains on the evaluating trials."""
    held_out = np.array([not motion.learn for motion in regression.motions])
    was = float(search.base.squares[held_out].sum())
    gains: Floats = np.array([1.0 - float(one.squares[held_out].sum()) / was for one in search.first])
    inflation = max(1.0, float(search.final.squares.sum() / search.told.sum()))
    total = np.array([float(one.squares.sum()) for one in search.first])
    odds = np.exp(-(total - total.min(initial=np.inf)) / (2.0 * inflation)) if len(total) else total
    support = odds / max(float(odds.sum()), 1e-300)
    if not search.causes:
        support = np.zeros(len(total))
    listed = [
        Tried(
            one.hypothesis.kind.name,
            tuple(j + 1 for j in one.hypothesis.joints),
            float(np.clip(gain_, 0.0, 1.0)),
            float(share),
        )
        for one, gain_, share in zip(search.first, gains, support, strict=True)
    ]
    listed += [Tried("stiction", (one.joint + 1,), float(np.clip(one.gain, 0.0, 1.0)), 1.0) for one in held]
    return sorted(listed, key=lambda one: -one.gain)


def _sticking(arm: Arm, held: Sequence[Holding]) -> Arm:
    effects = tuple(
        Effect("stiction", {"static_N_m": one.parameter.value}, joints=(one.joint + 1,)) for one in held
    )
    return replace(arm, effects=(*arm.effects, *effects)) if effects else arm
