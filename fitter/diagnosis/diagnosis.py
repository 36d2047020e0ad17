"""`diagnose`: from trials to a verdict."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from arm.model import Arm
from arm.regressor import standard_parameters
from fitter.data.motions import Measured
from fitter.data.resample import Uniform, resample, split_at_holes
from fitter.data.trials import FIT_CORNER, Trial, derive, undriven
from fitter.diagnosis.causes import Beginning, begin, find_causes
from fitter.diagnosis.chatter import chatter
from fitter.diagnosis.conclusion import concluded
from fitter.diagnosis.corner import corner_hz
from fitter.diagnosis.finding import Finding
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion, run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.reweighting import will_do
from fitter.diagnosis.screening import Candidate, fitted
from fitter.diagnosis.search import Search
from fitter.diagnosis.starts import Starts
from fitter.diagnosis.telling import finding_of
from fitter.diagnosis.unseen import UNSEEN, shows_only_where_it_is_judged
from fitter.dynamics.structure import structural_parameters
from limbcal.errors import DataError, NotIdentifiable
from limbcal.note import Note

Progress = Callable[[str, float], None]


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
    base = fitted(regression, Model())
    if shows_only_where_it_is_judged(regression, base, base):
        regression = regression.learning_from_all()
    tried = hypotheses(arm.n_joint, denied, driven=not free)
    regression, search = _searched(regression, tried, strict, say)
    say("describing what is left", 0.8)
    come_to = concluded(regression, search, strict)
    say("judging on the evaluating trials", 0.92)
    motions = run_of(arm, learning, evaluating, thin=False)
    finding = finding_of(regression, come_to, motions)
    unseen = regression.learns_from_all and come_to.search.causes
    warnings = chatter(arm, [*learning, *evaluating]) + ([UNSEEN] if unseen else [])
    finding = replace(finding, warnings=tuple(Note("doubt", warning) for warning in warnings))
    say("done", 1.0)
    return Diagnosis(finding, regression, come_to.search, motions, come_to.final)


def _searched(
    regression: Regression, tried: Sequence[Hypothesis], strict: bool, say: Progress
) -> tuple[Regression, Search]:
    """Return what a search has come to.

    It is made with the noise under the first cause, and made anew with that under all causes where it is another.
    """
    starts = Starts()

    def begun() -> Beginning:
        return begin(regression, tried, starts, lambda what, done: say(what, 0.4 * done))

    beginning = begun()
    if beginning.best is not None:
        weighted = regression.weighting_under(beginning.best.model, beginning.best.x)
        if not will_do(regression.weighting, weighted):
            regression = regression.weighted_by(weighted)
            beginning = begun()
    first = regression

    def is_right(candidate: Candidate) -> bool:
        return will_do(first.weighting, first.weighting_under(candidate.model, candidate.x))

    search = find_causes(
        *(regression, tried, starts, lambda what, done: say(what, 0.8 * done), beginning),
        strict=strict,
        is_right=is_right,
    )
    if search.from_all:
        regression = regression.learning_from_all()
    # A wrong drive is weighed by the noise that it lets through, which the first filter may have wrong.
    in_vain = strict and search.outdone and all(one.kind.place != "drive" for one in search.final.model.hypotheses)
    if search.causes and not in_vain and not is_right(search.final):
        regression = regression.weighted_by(regression.weighting_under(search.final.model, search.final.x))
        search = find_causes(
            *(regression, tried, starts, lambda what, done: say(f"once more, {what}", 0.8 * done)),
            before=search,
            strict=strict,
        )
        if search.from_all:
            regression = regression.learning_from_all()
    return regression, search


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
