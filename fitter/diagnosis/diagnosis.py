"""`diagnose`: from trials to a verdict."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.model import Arm, Effect, Floats
from arm.regressor import standard_parameters
from fitter.data.motions import Measured
from fitter.data.resample import Uniform, resample, split_at_holes
from fitter.data.trials import FIT_CORNER, Trial, derive, undriven
from fitter.diagnosis.causes import find_causes
from fitter.diagnosis.corner import corner_hz
from fitter.diagnosis.estimates import Estimates, estimates, extended_arm
from fitter.diagnosis.finding import Finding, NamedCause, Tried, Verdict
from fitter.diagnosis.holding import Holding, holdings
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.in_arm import Payload
from fitter.diagnosis.judgement import gain, judged
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion, run_of
from fitter.diagnosis.next_experiment import next_experiment
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.reweighting import will_do
from fitter.diagnosis.screening import Candidate, fitted
from fitter.diagnosis.search import Search
from fitter.diagnosis.settled import settled
from fitter.diagnosis.unknown import Remainder, describe
from fitter.diagnosis.untold import without_untold
from fitter.diagnosis.verdict import verdict_of
from fitter.dynamics.structure import structural_parameters
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import DataError, NotIdentifiable

Progress = Callable[[str, float], None]

#: Evaluating trials show what learning trials don't if they leave this much beyond noise of one, and those not
#: more than this.
_MUCH, _NOTHING = 0.3, 0.1
UNSEEN = "what is wrong shows in evaluating trials only, so causes were sought in all: the gain is no prediction"


@dataclass(frozen=True)
class Diagnosis:
    """A finding, and what pictures of it need.

    Attributes
    ----------
    finding : Finding
    regression : Regression
    search : Search
    motions : list of Motion
        All trials, not thinned.
    final : Candidate
        The model that was accepted.
    """

    finding: Finding
    regression: Regression
    search: Search
    motions: list[Motion]
    final: Candidate


def diagnose(
    arm: Arm,
    learn: Sequence[Measured],
    evaluate: Sequence[Measured],
    *,
    rate_hz: float | None = None,
    denied: tuple[str, ...] = (),
    free: bool = False,
    strict: bool = True,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find out what a calibrated simulation gets wrong, and why.

    Parameters
    ----------
    arm : Arm
        Geometry, gravity and control law; what it has of dynamics is not used.
    learn, evaluate : sequence of Measured
        Joint motion with torque, or with the target of a known law.
    rate_hz : float, optional
        To resample to.
    denied : tuple of str
        Frictions that the base model is denied: ``D``, ``fc``.
    free : bool
        The arm swings freely: its torque is zero.
    strict : bool
        Whether causes are named only if next to nothing is left that they don't explain. Real machines always have
        something more: without this the causes are named, and what is left is described.
    progress : callable, optional
        Told what is being done, and how much of all is done (0 to 1).

    Raises
    ------
    DataError
        If a set is empty, or nothing says which torque drove a trial.
    """
    for name, some in (("learning", learn), ("evaluating", evaluate)):
        if not some:
            raise DataError(f"no {name} trial; expected at least one: what is learnt from cannot judge")
    grids = [
        [resample(part, rate_hz) for one in some for part in split_at_holes(one)] for some in (learn, evaluate)
    ]
    say = progress or (lambda _what, _done: None)
    corner = corner_hz([grid for some in grids for grid in some])
    learning, evaluating = _trials(grids, corner, free)
    regression = Regression(arm, run_of(arm, learning, evaluating), denied, _scale_of(arm) if free else None)
    unseen = _shows_only_where_it_is_judged(regression)
    if unseen:
        regression.learn_from_all()
    tried = hypotheses(arm.n_joint, denied, driven=not free)
    search = find_causes(regression, tried, lambda what, done: say(what, 0.8 * done))
    weighted = regression.weighting_under(search.final.model, search.final.x)
    # A wrong drive is weighed by the noise that it lets through, which the first filter may have wrong.
    in_vain = strict and search.outdone and all(one.kind.place != "drive" for one in search.final.model.hypotheses)
    if search.causes and not in_vain and not will_do(regression.weighting, weighted):
        regression = regression.weighted_by(weighted)
        search = find_causes(regression, tried, lambda what, done: say(f"once more, {what}", 0.8 * done))
    say("describing what is left", 0.8)
    final, numbers = settled(regression, search.final)
    search = replace(search, final=final)
    told = without_untold(regression, search, numbers) if strict else search
    if told is not search:
        search, numbers = told, estimates(regression, told.final)
    remainder = describe(regression, search.final)
    held = holdings(regression, search.final, numbers.covariance)
    verdict = verdict_of(search, remainder, numbers, bool(held), strict)
    final = search.final
    suspected: tuple[Hypothesis, ...] = ()
    if verdict in ("unexplained", "none") and search.causes:
        suspected = tuple(search.final.model.hypotheses) if verdict == "unexplained" else ()
        final = search.base
        remainder = describe(regression, final)
    say("judging on the evaluating trials", 0.92)
    motions = run_of(arm, learning, evaluating, thin=False)
    finding = _told(regression, search, final, numbers, remainder, verdict, held, motions)
    if unseen and search.causes:
        finding = replace(finding, notes=(*finding.notes, UNSEEN))
    if suspected:
        places = tuple((one.kind.name, tuple(j + 1 for j in one.joints)) for one in suspected)
        finding = replace(finding, suspected=places)
    say("done", 1.0)
    return Diagnosis(finding, regression, search, motions, final)


def _shows_only_where_it_is_judged(regression: Regression) -> bool:
    """Say whether the learning trials fit the base model, and the evaluating ones don't."""
    base = fitted(regression, Model())
    told = np.array([regression.weighting.told(motion) for motion in regression.motions], dtype=np.float64)
    learnt = np.array([motion.learn for motion in regression.motions])
    excess = [base.squares[some].sum() / told[some].sum() - 1.0 for some in (learnt, ~learnt)]
    return bool(excess[1] > _MUCH and excess[0] < _NOTHING)


def _scale_of(arm: Arm) -> tuple[int, float]:
    """Return the standard parameter, and its value in the arm file, that tells the scale of an undriven arm.

    It is the last link's inertia about its axis.

    Raises
    ------
    NotIdentifiable
        If the arm file has none.
    """
    base = structural_parameters(arm)
    values = base.combination @ standard_parameters(arm)
    inertial = [k for k, column in enumerate(base.independent) if column < 10 * arm.n_joint and column % 10 < 6]
    if not inertial or not values[inertial[-1]] > 0.0:
        raise NotIdentifiable(
            f"arm {arm.name}: nothing drives it, so only ratios can be told; "
            "expected the last link's inertia in its file"
        )
    return base.independent[inertial[-1]], float(values[inertial[-1]])


def _trials(grids: Sequence[Sequence[Uniform]], cutoff_hz: float, free: bool) -> list[list[Trial]]:
    sets = [[derive(grid, cutoff_hz, FIT_CORNER * cutoff_hz) for grid in some] for some in grids]
    return [[undriven(trial) for trial in some] for some in sets] if free else sets


def _told(
    regression: Regression,
    search: Search,
    final: Candidate,
    numbers: Estimates,
    remainder: Remainder,
    verdict: Verdict,
    held: list[Holding],
    motions: list[Motion],
) -> Finding:
    plain = numbers if search.final is search.base else estimates(regression, search.base)
    base_arm = extended_arm(regression, search.base, plain)
    found = plain if final is search.base else numbers
    extended = base_arm if final is search.base else extended_arm(regression, final, found)
    judging = [motion for motion in motions if not motion.learn]
    causes = [] if final is search.base else _causes(regression, search, found)
    if verdict in ("named", "ambiguous"):
        causes += [NamedCause("stiction", (one.joint + 1,), {"static_N_m": one.parameter}, 1.0) for one in held]
        extended = _sticking(extended, held)
    before = judged(regression, search.base, base_arm, judging)
    after = before if extended is base_arm else judged(regression, final, extended, judging)
    alike = sorted({cause.effect for cause in causes})
    confusable = [] if final is search.base else _confusable(search)
    joints = [j for cause in causes for j in cause.joints]
    return Finding(
        verdict=verdict,
        causes=causes,
        candidates=_tried(regression, search, held),
        confusable=confusable,
        next_experiment=next_experiment(verdict, alike, joints, remainder.depends_on),
        before=before,
        after=after,
        gain=gain(before, after),
        remainder=remainder,
        structure=search.structure,
        explained=search.explained,
        base_arm=base_arm,
        arm=extended,
        notes=sorted({note for motion in motions for note in motion.trial.notes}),
    )


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
