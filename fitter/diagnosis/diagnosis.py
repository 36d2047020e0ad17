"""`diagnose`: from trials to a verdict."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from arm.model import Arm
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.derived_trial import derive
from fitter.data.motions import Measured
from fitter.data.resample import Uniform, resample, split_at_holes
from fitter.data.trial import Trial, undriven
from fitter.data.trial_filter import FIT_CORNER
from fitter.diagnosis.accepted_pulses import with_likeliest_pulses, with_pulses
from fitter.diagnosis.conclusion import concluded, finding_of
from fitter.diagnosis.cutoff import chatter, corner_hz
from fitter.diagnosis.equal_causes import with_equals
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.finding import Finding
from fitter.diagnosis.given_effects import acting_arm, as_in_file, given_model
from fitter.diagnosis.held_out import judged_sets
from fitter.diagnosis.hypotheses import hypotheses, reaches_of
from fitter.diagnosis.least_squares import CLEAR_RATIO, MOST_CAUSES
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.polish import polished
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from fitter.diagnosis.screening import events, screen
from fitter.diagnosis.search import Search, cause_of, supports
from fitter.diagnosis.stepwise import Found, Stepwise
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from fitter.dynamics.evaluation import HORIZON_S
from fitter.dynamics.free_swing import last_inertia
from limbcal.errors import DataError, NotIdentifiable
from limbcal.note import Note

Progress = Callable[[str, float], None]
#: Returns the equations of some motions.
Equations = Callable[[Sequence[Motion]], Regression]

_UNSEEN = "what is wrong shows in evaluating trials only, so causes were sought in all: the gain is no prediction"


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
    horizon_s: float = HORIZON_S,
    judge: Mapping[str, Sequence[Measured]] | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find out what a calibrated simulation gets wrong, and why.

    Parameters
    ----------
    arm : Arm
        Geometry, gravity, control law and effects; what it has of masses and friction is not used.
    learn, evaluate : sequence of Measured
        Joint motion with torque, or with the target of a known law.
    rate_hz : float, optional
        To resample to.
    denied : tuple of str
        Frictions that the base model is denied: ``D``, ``fc``.
    free : bool
        The arm swings freely: its torque is zero.
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    judge : mapping of str to sequence of Measured, optional
        Sets of trials that have no say in anything, by their names.
    progress : callable, optional
        Called with what is being done, and how much of all is done (0 to 1).

    Raises
    ------
    DataError
        If a set is empty, or nothing says which torque drove a trial.
    """
    for name, some in (("learning", learn), ("evaluating", evaluate)):
        if not some:
            raise DataError(f"no {name} trial; expected at least one: what is learnt from cannot judge")
    grids = [_grids(some, rate_hz) for some in (learn, evaluate)]
    say = progress or (lambda _what, _done: None)
    corner = corner_hz([grid for some in grids for grid in some])
    learning, evaluating = _trials(grids, corner, free)
    scale = _scale_of(arm) if free else None
    motions = run_of(arm, learning, evaluating, thin=False)
    acting, given = acting_arm(arm, motions), given_model(arm)

    def equations(some: Sequence[Motion]) -> Regression:
        return regression_of(acting, some, denied, scale, given)

    likelihood, search = _searched(equations, run_of(arm, learning, evaluating), say)
    say("describing the residual", 0.8)
    come_to = concluded(likelihood.regression, search)
    say("moving the numbers by simulated motion", 0.9)
    polish = polished(likelihood.regression, come_to, motions, horizon_s)
    if polish is not None and polish.said.kept:
        come_to = replace(come_to, final=polish.candidate, numbers=polish.numbers)
    say("judging on the evaluating trials", 0.95)
    finding = finding_of(
        likelihood.regression, come_to, motions, horizon_s, None if polish is None else polish.said
    )
    base_arm, extended = (as_in_file(arm, acting, one, motions) for one in (finding.base_arm, finding.arm))
    finding = replace(finding, base_arm=base_arm, arm=base_arm if finding.arm is finding.base_arm else extended)
    if judge:
        say("judging on the trials that had no say", 0.97)
        unseen = _trials([_grids(some, rate_hz) for some in judge.values()], corner, free)
        every = run_of(arm, learning, [*evaluating, *chain.from_iterable(unseen)], thin=False)
        others = every[len(motions) :]
        names = [name for name, some in zip(judge, unseen, strict=True) for _ in some]
        models = (
            (come_to.search.base, acting_arm(finding.base_arm, every)),
            (come_to.final, acting_arm(finding.arm, every)),
        )
        finding = replace(finding, judged=judged_sets(likelihood.regression, models, others, names, horizon_s))
    warnings = chatter(arm, [*learning, *evaluating]) + ([_UNSEEN] if search.from_all and search.causes else [])
    finding = replace(finding, warnings=tuple(Note("doubt", warning) for warning in warnings))
    say("done", 1.0)
    return Diagnosis(finding, likelihood.regression, come_to.search, motions, come_to.final)


def _searched(equations: Equations, motions: Sequence[Motion], say: Progress) -> tuple[TorqueLikelihood, Search]:
    """Return what a search has come to: by the learning trials, or by all if only the others show something."""
    likelihood, search, found = _found(equations, motions, say)
    judging = np.array([not motion.learn for motion in motions])
    chi2_ratio = found.final.candidate.squares[judging].sum() / likelihood.regression.n_effective[judging].sum()
    # Causes that were found predict no better than their numbers are known.
    shown = chi2_ratio > CLEAR_RATIO if found.steps else not likelihood.is_exact(found.final, everywhere=True)
    from_all = likelihood.floor.is_none and shown
    if from_all:
        motions = [replace(motion, learn=True) for motion in motions]
        likelihood, search, found = _found(equations, motions, say)
    base_floor = likelihood.base_floor
    if not likelihood.is_exact(found.final, everywhere=True):
        found = with_pulses(likelihood, search, found)
    found = with_equals(likelihood, found)
    regression, model = likelihood.regression, found.final.candidate.model
    base = fitted(regression, Model())
    final = with_likeliest_pulses(regression, fitted(regression, model)) if model.hypotheses else base
    return likelihood, Search(
        base,
        final,
        [cause_of(place, found) for place in range(len(found.steps))],
        found.base.candidate,
        [one.candidate for one in found.first],
        supports(found.first),
        likelihood.floor,
        base_floor,
        from_all,
        likelihood.in_vain,
    )


def _found(
    equations: Equations, motions: Sequence[Motion], say: Progress
) -> tuple[TorqueLikelihood, Stepwise, Found]:
    """Return the likelihood, the search by it, and what it has found."""
    regression = equations(motions)
    reaches = reaches_of(regression.arm, [motion.q for motion in motions])
    driven = regression.equations.known is None
    tried = hypotheses(regression.arm.n_joint, regression.denied, driven=driven, reaches=reaches)
    count = [0]

    def trying(done: int, total: int) -> None:
        part = 0.5 ** count[0]
        say("trying every effect", 0.8 * (1.0 - part + 0.5 * part * done / total))

    def one_more(n: int) -> None:
        count[0] = n

    likelihood = TorqueLikelihood(regression, tried, screen, trying, events)
    search = Stepwise(likelihood, len(tried), MOST_CAUSES, one_more)
    return likelihood, search, search.run()


def _scale_of(arm: Arm) -> tuple[int, float]:
    """Return the standard parameter, and its value in the arm file, that sets the scale of an undriven arm.

    It is the last link's inertia about its axis.

    Raises
    ------
    NotIdentifiable
        If the arm file has none.
    """
    base = structural_parameters(arm)
    values = base.combination @ standard_parameters(arm)
    last = last_inertia(base, arm.n_joint)
    if last is None or not values[last] > 0.0:
        raise NotIdentifiable(
            f"arm {arm.name}: nothing drives it, so only ratios can be identified; "
            "expected the last link's inertia in its file"
        )
    return base.independent[last], float(values[last])


def _grids(motions: Sequence[Measured], rate_hz: float | None) -> list[Uniform]:
    return [resample(part, rate_hz) for one in motions for part in split_at_holes(one)]


def _trials(grids: Sequence[Sequence[Uniform]], cutoff_hz: float, free: bool) -> list[list[Trial]]:
    sets = [[derive(grid, cutoff_hz, FIT_CORNER * cutoff_hz) for grid in some] for some in grids]
    return [[undriven(trial) for trial in some] for some in sets] if free else sets
