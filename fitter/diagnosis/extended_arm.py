"""A fitted model as an arm with effects, and its factors and psi as that arm's numbers."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import with_base_values
from arm.model import Arm, Effect, Estimate, Floats, Joint
from arm.physical_links import is_possible, link_parameters
from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.model import Candidate, Hypothesis, Model, is_one
from fitter.diagnosis.payload import Payload
from fitter.diagnosis.regression import Regression
from fitter.dynamics.physical import nearest_possible
from fitter.dynamics.shooting_effects import Numbers, numbers_of
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import NotConverged


@dataclass(frozen=True)
class ModelNumbers:
    """A fitted model whose factors and psi, one after the other, are moved together.

    Attributes
    ----------
    candidate : Candidate
    numbers : Numbers
        Of its arm.
    base : (n_base,) int
        Where the factors that are base parameters are among the arm's numbers.
    effects : sequence of sequence of (int, int)
        Of each hypothesis: which of its parameters is which of the arm's numbers.
    """

    candidate: Candidate
    numbers: Numbers
    base: NDArray[np.intp]
    effects: Sequence[Sequence[tuple[int, int]]]

    @property
    def start(self) -> Floats:
        """Factors and psi, base parameters as the arm has them: it is possible, and its friction brakes."""
        x = self.candidate.x.copy()
        x[: len(self.base)] = self.numbers.values[self.base]
        return np.concatenate([x, self.candidate.model.flat])

    @property
    def lasting(self) -> NDArray[np.bool_]:
        """Which of them are of what is always there: learning trials know nothing of what others have."""
        model = self.candidate.model
        stays = [one.is_intermittent for one in model.hypotheses]
        columns = np.repeat(stays, [one.n_column for one in model.hypotheses])
        psi = np.repeat(stays, [len(own) for own in model.psi])
        return ~np.concatenate([np.zeros(len(self.base)), columns, psi]).astype(np.bool_)

    def at(self, flat: Floats) -> Candidate:
        """Return the model with other factors and psi."""
        n = len(self.candidate.x)
        return replace(self.candidate, model=self.candidate.model.at(flat[n:]), x=flat[:n])

    def values(self, flat: Floats) -> Floats:
        """Return the arm's numbers, (n_number,), for factors and psi."""
        moved, values = self.at(flat), self.numbers.values
        values[self.base] = moved.x[: len(self.base)]
        at = len(self.base)
        for one, psi, places in zip(moved.model.hypotheses, moved.model.psi, self.effects, strict=True):
            own = one.numbers(psi, moved.x[at : at + one.n_column])
            at += one.n_column
            for k, place in places:
                values[place] = own[k]
        return values

    def admitted(self, flat: Floats) -> Floats:
        """Return what must not be negative: how far effects' numbers and psi are within their limits."""
        values, (low, high) = self.values(flat), self.numbers.bounds
        model = self.candidate.model
        own = [place for places in self.effects for _, place in places]
        psi = flat[len(self.candidate.x) :]
        least, most = (
            np.concatenate([np.zeros(0), *(getattr(one, side) for one in model.hypotheses)])
            for side in ("low", "high")
        )
        return np.concatenate([(values - low)[own], (high - values)[own], psi - least, most - psi])


def model_numbers(
    arm: Arm, found: Estimates, candidate: Candidate, kept: Sequence[int], given: int
) -> ModelNumbers:
    """Return a fitted model's numbers in an arm that has its effects.

    Parameters
    ----------
    arm : Arm
        See `fitter.diagnosis.estimates.extended_arm`.
    found : Estimates
    candidate : Candidate
    kept : sequence of int
        Standard parameters that its factors stand for: base parameters but those that were denied or known.
    given : int
        How many effects the arm had before.
    """
    numbers = numbers_of(arm, found.base)
    effects, at = [], given
    for one in candidate.model.hypotheses:
        places = [(k, numbers.place(at, name)) for k, name in enumerate(one.names)]
        effects.append([(k, place) for k, place in places if place is not None and not one.is_intermittent])
        at += max(1, sum(name.startswith("start_s_") for name in one.names))
    base = np.array([found.base.independent.index(int(column)) for column in kept], dtype=np.intp)
    return ModelNumbers(candidate, numbers, base, effects)


def extended_arm(regression: Regression, fitted: Candidate, found: Estimates) -> Arm:
    """Return the arm with the base parameters that were learnt, and with its effects."""
    arm = regression.arm
    learnt = np.nan_to_num(found.values)
    tilted = regression.hypothetical(fitted.model, regression.motions[0]).arm
    moved = with_base_values(replace(arm, gravity_m_s2=tilted.gravity_m_s2), found.base, learnt)
    if not all(is_possible(link_parameters(joint.link)) for joint in moved.joints):
        with suppress(NotConverged):
            moved = nearest_possible(arm, found.base, found.values)
    effects = tuple(
        _effect(hypothesis, numbers)
        for hypothesis, numbers in zip(fitted.model.hypotheses, found.effects, strict=True)
    )
    split = [one for effect in effects for one in _single(effect)]
    parameters = {
        name: Estimate(float(value), float(std))
        for name, value, std in zip(found.base.names, found.values, found.std, strict=True)
        if np.isfinite(value)
    }
    return replace(
        moved,
        joints=tuple(map(_braked, moved.joints)),
        gravity_m_s2=arm.gravity_m_s2,
        base_parameters=parameters,
        effects=(*given_effects(arm, fitted.model), *split),
    )


def given_effects(arm: Arm, model: Model) -> list[Effect]:
    """Return an arm's effects but those that a model has others in the stead of.

    Parameters
    ----------
    arm : Arm
        As `fitter.diagnosis.given_effects.acting_arm` has it.
    model : Model
    """
    gone = {(one.kind.name, j + 1) for one in model.hypotheses if is_one(one.kind) for j in one.joints}
    return [one for one in arm.effects if not gone.intersection((one.name, joint) for joint in one.joints)]


def _braked(joint: Joint) -> Joint:
    """Return a joint whose Coulomb friction brakes: one that is fitted to push would rattle in a simulation."""
    friction = joint.friction
    return replace(joint, friction=replace(friction, coulomb_N_m=max(friction.coulomb_N_m, 0.0)))


def _effect(hypothesis: Hypothesis, numbers: dict[str, FittedParameter]) -> Effect:
    values: dict[str, object] = {name: number.value for name, number in numbers.items()}
    if isinstance(hypothesis, Payload) and hypothesis.trials:
        values |= {"trials": sorted(hypothesis.trials)}
    return Effect(hypothesis.kind.name, values, joints=tuple(j + 1 for j in hypothesis.joints))


def _single(effect: Effect) -> list[Effect]:
    """Return one effect for each of several pushes."""
    if "start_s_1" not in effect.parameters:
        return [effect]
    pushes = []
    k = 1
    while f"start_s_{k}" in effect.parameters:
        names = ("start_s", "duration_s", "torque_N_m")
        pushes.append(replace(effect, parameters={name: effect.parameters[f"{name}_{k}"] for name in names}))
        k += 1
    return pushes
