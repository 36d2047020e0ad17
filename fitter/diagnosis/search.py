"""The result of the search for causes, for evaluation and report."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.model import Floats
from fitter.diagnosis.evidence import Fit, Floor, penalised_log_likelihood
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.stepwise import Found
from fitter.search.fitted_parameter import FittedParameter

Verdict = Literal["named", "ambiguous", "none", "unexplained"]


@dataclass(frozen=True)
class Cause:
    """One accepted hypothesis, and what was tried in its stead, all under the weights of that step.

    Attributes
    ----------
    place : int
        Its place in the model.
    before, itself : Candidate
        Without and with it.
    rivals : sequence of Candidate
        As likely, with as many numbers.
    larger : sequence of Candidate
        As likely, with more numbers.
    beaten : sequence of Candidate
        All others, the likeliest first.
    support : sequence of float
        Of it and of each rival: the likelihoods' ratios beside all other causes, one in all.
    beside : sequence of Candidate
        The rivals beside all other causes, in their order.
    """

    place: int
    before: Candidate
    itself: Candidate
    rivals: Sequence[Candidate] = ()
    larger: Sequence[Candidate] = ()
    beaten: Sequence[Candidate] = ()
    support: Sequence[float] = (1.0,)
    beside: Sequence[Candidate] = ()

    def takes_away(self, which: Sequence[bool]) -> float:
        """Return the share of the squared residual of some trials that it takes away."""
        was, remaining = (float(one.squares[np.asarray(which)].sum()) for one in (self.before, self.itself))
        return 1.0 - remaining / was if was > 0.0 else 0.0


@dataclass(frozen=True)
class Search:
    """The result of the search for causes.

    Attributes
    ----------
    base, final : Candidate
        Without and with all causes, under the same weights.
    causes : sequence of Cause
        In the order of the model's hypotheses.
    screening_base : Candidate
        The base model as `first` was held against it.
    first : sequence of Candidate
        Every hypothesis that was an option added to the base model alone, the likeliest first.
    support : sequence of float
        Of each of these.
    floor : Floor
        Of the final model.
    base_floor : Floor
        Of the base model.
    from_all : bool
        Whether evaluating trials were learnt from, too.
    in_vain : sequence of Candidate
        What was tried with the base model and was no option, see `TorqueLikelihood`.
    """

    base: Candidate
    final: Candidate
    causes: Sequence[Cause]
    screening_base: Candidate
    first: Sequence[Candidate]
    support: Sequence[float]
    floor: Floor
    base_floor: Floor
    from_all: bool = False
    in_vain: Sequence[Candidate] = ()


def cause_of(place: int, found: Found) -> Cause:
    """Return one of the accepted steps as a cause, at its place in the final model.

    An equal that was accepted as a further cause is none.
    """
    step, named = found.steps[place], {one.hypothesis.key for one in found.steps}
    pairs = zip(step.equals, step.beside, strict=True)
    equals = [(one, beside) for one, beside in pairs if one.candidate.hypothesis.key not in named]
    rivals = [(one, beside) for one, beside in equals if beside.n_number == found.final.n_number]
    larger = [one for one, beside in equals if beside.n_number != found.final.n_number]
    alike = {step.hypothesis.key, *(one.candidate.hypothesis.key for one, _ in equals)}
    return Cause(
        place,
        step.before.candidate,
        step.fit.candidate,
        [one.candidate for one, _ in rivals],
        [one.candidate for one in larger],
        [one.candidate for one in step.options if one.candidate.hypothesis.key not in alike],
        supports([found.final, *(beside for _, beside in rivals)]),
        [beside.candidate for _, beside in rivals],
    )


def supports(fits: Sequence[Fit]) -> list[float]:
    """Return the likelihoods of models as shares of their sum."""
    if not fits:
        return []
    log_likelihood: Floats = np.array([penalised_log_likelihood(one) for one in fits])
    odds = np.exp(log_likelihood - log_likelihood.max())
    return [float(one) for one in odds / odds.sum()]


@dataclass(frozen=True)
class StaticFriction:
    """Static friction of one joint.

    Attributes
    ----------
    joint : int
        From 0.
    parameter : FittedParameter
        F, the most that has held it [N m or N].
    gain : float
        Share of the squared torque beyond Coulomb friction, in the evaluating trials' rests, that the learning
        trials' F allows for.
    """

    joint: int
    parameter: FittedParameter
    gain: float
