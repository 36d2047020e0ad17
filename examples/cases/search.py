"""A plain search for causes with the diagnosis' equations: forwards only, and without events.

`fitter.diagnosis.diagnosis.diagnose` also looks for pushes and loads that come and go, and for drives that are
late by any time. Nothing is known of pushes or loads in these recordings, and what these can be bent into is large
where the model that one starts from lacks gravity or friction altogether. Here they are set aside. Everything else
is the diagnosis' own: its equations, its hypotheses, its noise. Nothing is fitted to the evaluating trials.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.resample import Uniform, resample, split_at_holes
from fitter.data.trials import FIT_CORNER, Trial, derive, undriven
from fitter.diagnosis.corner import corner_hz
from fitter.diagnosis.dependence import Dependence
from fitter.diagnosis.estimates import estimates, extended_arm
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion, run_of
from fitter.diagnosis.refinement import refined
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate
from fitter.diagnosis.turned_gravity import turned
from fitter.diagnosis.unknown import Remainder, describe
from fitter.search.fitted_parameter import FittedParameter

#: A cause must lower what is left by this share, on the learning and on the evaluating trials.
WORTH = 0.03
#: What takes away so much less than the best is its equal: the one with fewest numbers is taken.
EQUAL = 0.02
MOST = 8
#: A drive that is later than this is none [s]: the equation then compares a motion with the mean of a torque.
LATEST_S = 0.05
#: So many of the best hypotheses have their nonlinear numbers refined.
_LEADING = 4


@dataclass(frozen=True)
class Step:
    """A model with the first few causes.

    Attributes
    ----------
    hypothesis : Hypothesis or None
        The last of them; none in the first step.
    numbers : mapping from name to FittedParameter
        Of that cause, in the model with all causes.
    arm : Arm
        To be simulated, with the causes up to this one.
    model : Candidate
    runner_up : Hypothesis or None
        What would have explained most in its stead, and the share of its gain that this reaches.
    reaches : float
    """

    hypothesis: Hypothesis | None
    numbers: Mapping[str, FittedParameter]
    arm: Arm
    model: Candidate
    runner_up: Hypothesis | None = None
    reaches: float = 0.0


@dataclass(frozen=True)
class Found:
    """What a search has come to.

    Attributes
    ----------
    regression : Regression
    motions : list of Motion
        All trials, not thinned.
    steps : list of Step
        From the model that was started from to the last.
    told : float
        How many numbers the equations tell: what noise alone would leave.
    remainder : Remainder
    """

    regression: Regression
    motions: list[Motion]
    steps: list[Step]
    told: float
    remainder: Remainder

    @property
    def dependences(self) -> list[Dependence]:
        """On what the remaining torque depends."""
        return self.remainder.dependences

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {
            "causes": [
                {
                    "effect": step.hypothesis.kind.name,
                    "joints": [j + 1 for j in step.hypothesis.joints],
                    "parameters": {name: p.document() for name, p in step.numbers.items()},
                }
                for step in self.steps
                if step.hypothesis is not None
            ],
            "squares_by_noise": [float(step.model.squares.sum()) / self.told for step in self.steps],
            "depends_on": list(self.remainder.depends_on),
        }


def find(
    arm: Arm,
    learn: Sequence[Measured],
    evaluate: Sequence[Measured],
    *,
    rate_hz: float,
    denied: tuple[str, ...] = (),
    known: tuple[int, float] | None = None,
    most: int = MOST,
    set_aside: tuple[str, ...] = (),
) -> Found:
    """Search for causes, the most explaining first.

    Parameters
    ----------
    arm, learn, evaluate, rate_hz, denied
        As for `diagnose`.
    known : (column, value), optional
        The standard parameter that tells the scale of an arm that swings freely; its torque is then zero.
    most : int
        So many causes, and no more.
    set_aside : tuple of str
        Effects that are not tried.
    """
    grids = [
        [resample(part, rate_hz) for one in some for part in split_at_holes(one)] for some in (learn, evaluate)
    ]
    corner = corner_hz([grid for some in grids for grid in some])
    learning, evaluating = (_trials(some, corner, known is not None) for some in grids)
    regression = Regression(arm, run_of(arm, learning, evaluating), denied, known)
    tried = [
        one for one in hypotheses(arm.n_joint, denied, driven=known is None) if one.kind.name not in set_aside
    ]
    models = [_learnt(regression, Model())]
    beside: list[tuple[Hypothesis | None, float]] = [(None, 0.0)]
    while len(models) <= most:
        founded = [one for one in tried if _is_founded(one, models[-1].model, denied)]
        ranked = _ranked(regression, models[-1], founded)
        ranked = [one for one in ranked if _worth_it(regression, models[-1], one)]
        if not ranked:
            break
        ranked = _simplest_first(regression, models[-1], ranked)
        was = models[-1].squares.sum()
        second = ranked[1] if len(ranked) > 1 else None
        share = float((was - second.squares.sum()) / (was - ranked[0].squares.sum())) if second else 0.0
        anew = _learnt(regression, refined(regression, ranked[0].model, regression.learning))
        beside.append((second.hypothesis if second else None, share))
        models.append(anew if _worth_it(regression, models[-1], anew) else ranked[0])
    models = [_turned(regression, model) for model in models]
    numbers = estimates(regression, models[-1]).effects
    listed = []
    for k, (model, (second_best, share)) in enumerate(zip(models, beside, strict=True)):
        extended = extended_arm(regression, model, estimates(regression, model))
        last = model.model.hypotheses[-1] if k else None
        listed.append(Step(last, numbers[k - 1] if k else {}, extended, model, second_best, share))
    told = float(sum(regression.weighting.told(motion) for motion in regression.motions))
    whole = run_of(arm, learning, evaluating, thin=False)
    return Found(regression, whole, listed, told, describe(regression, models[-1]))


def _is_founded(hypothesis: Hypothesis, model: Model, denied: tuple[str, ...]) -> bool:
    """Say whether a joint has what a hypothesis builds on: Stribeck's friction falls to Coulomb's."""
    if hypothesis.kind.name != "stribeck" or "fc" not in denied:
        return True
    return any(one.key == ("coulomb", hypothesis.joints) for one in model.hypotheses)


def _trials(grids: Sequence[Uniform], corner: float, free: bool) -> list[Trial]:
    trials = [derive(grid, corner, FIT_CORNER * corner) for grid in grids]
    return [undriven(trial) for trial in trials] if free else trials


def _learnt(regression: Regression, model: Model) -> Candidate:
    """Return a model whose factors the learning trials alone have told."""
    x = regression.solve(model, regression.learning)
    return Candidate(model, x, regression.squares(model, x))


def _turned(regression: Regression, model: Candidate) -> Candidate:
    """Return a model in which gravity is no stronger than it is, unless the data says so."""
    turning = turned(regression, model.model, estimates(regression, model))
    return model if turning is None else _learnt(regression, refined(regression, turning, regression.learning))


def _ranked(regression: Regression, before: Candidate, tried: Sequence[Hypothesis]) -> list[Candidate]:
    """Return every hypothesis beside a model, the leading ones refined, in the order of what they leave."""
    known = {hypothesis.key for hypothesis in before.model.hypotheses}
    candidates = []
    for hypothesis in (one for one in tried if one.key not in known):
        starts = [psi for psi in hypothesis.starts(regression.learning) if not _too_late(hypothesis, psi)]
        models = [before.model.plus(hypothesis, psi) for psi in starts]
        solved = ((model, regression.solve(model, regression.learning)) for model in models)
        left = [float(regression.squares(model, x, regression.learning).sum()) for model, x in solved]
        best = models[int(np.argmin(left))]
        # A limit of the drive may be far below the starts that a diagnosis tries.
        if len(hypothesis.low) and (hypothesis.is_gradual or hypothesis.kind.name == "torque_saturation"):
            best = refined(regression, best, regression.learning, len(known))
        candidates.append(_learnt(regression, best))
    candidates = [one for one in candidates if _possible(one)]
    candidates.sort(key=lambda one: _by_learning(regression, one))
    for k, one in enumerate(candidates[:_LEADING]):
        finer = _learnt(regression, refined(regression, one.model, regression.learning, len(known)))
        if _possible(finer) and _by_learning(regression, finer) < _by_learning(regression, one):
            candidates[k] = finer
    return sorted(candidates, key=lambda one: _by_learning(regression, one))


def _simplest_first(regression: Regression, before: Candidate, ranked: list[Candidate]) -> list[Candidate]:
    """Return candidates with the one of fewest numbers first among those that are equal to the best."""
    was = _by_learning(regression, before)
    reach = (1.0 - EQUAL) * (was - _by_learning(regression, ranked[0]))
    equal = [one for one in ranked if was - _by_learning(regression, one) >= reach]
    first = min(equal, key=lambda one: (one.hypothesis.n_number, _by_learning(regression, one)))
    return [first, *(one for one in ranked if one is not first)]


def _by_learning(regression: Regression, one: Candidate) -> float:
    return float(sum(one.squares[k] for k, motion in enumerate(regression.motions) if motion.learn))


def _possible(one: Candidate) -> bool:
    hypothesis, psi = one.hypothesis, one.model.psi[-1]
    factors = one.x[len(one.x) - hypothesis.n_column :]
    return hypothesis.possible(psi, factors) and not _too_late(hypothesis, psi)


def _too_late(hypothesis: Hypothesis, psi: Sequence[float]) -> bool:
    return hypothesis.kind.name in ("actuator_lag", "actuator_delay") and psi[0] > LATEST_S


def _worth_it(regression: Regression, before: Candidate, one: Candidate) -> bool:
    """Say whether a candidate lowers what is left, on trials it has learnt from and on those it has not seen.

    What need not show in every trial, such as a limit of the drive, must do no harm where it has not been learnt.
    """
    learn = np.array([motion.learn for motion in regression.motions])
    asked = {True: 1.0 - WORTH, False: 1.0 + WORTH if one.hypothesis.is_event else 1.0 - WORTH}
    sets = ((asked[True], learn), (asked[False], ~learn))
    return all(one.squares[some].sum() < share * before.squares[some].sum() for share, some in sets)
