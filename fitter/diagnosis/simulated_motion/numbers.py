"""The numbers of an arm that simulations are shot with: its base parameters, then those of its effects."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.effects.catalogue import catalogue
from arm.model import Arm, Effect, Floats
from arm.regressor import standard_parameters


@dataclass(frozen=True)
class Numbers:
    """All numbers of an arm: base parameters, then those of its effects.

    Attributes
    ----------
    arm : Arm
    base : BaseParameters
    places : tuple of (effect, parameter)
        Where the effects' numbers are: the effect's place in the arm, and the parameter's name.
    """

    arm: Arm
    base: BaseParameters
    places: tuple[tuple[int, str], ...]

    @property
    def values(self) -> Floats:
        """Return the numbers as the arm has them, (n_number,)."""
        effects = [_number(self.arm.effects[k], name) for k, name in self.places]
        return np.concatenate([self.base.combination @ standard_parameters(self.arm), effects])

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Return what they may be, (n_number,) each: the catalogue's limits; base parameters have none."""
        kinds = [{p.name: p for p in catalogue()[effect.name].parameters} for effect in self.arm.effects]
        low, high = (
            np.array([getattr(kinds[k][name], side) for k, name in self.places]) for side in ("low", "high")
        )
        free = np.full(len(self.base.names), np.inf)
        return np.concatenate([-free, low]), np.concatenate([free, high])

    def place(self, effect: int, name: str) -> int | None:
        """Return where a number of an effect is among all, or None if it is none of them."""
        at = (effect, name)
        return len(self.base.names) + self.places.index(at) if at in self.places else None

    def with_effects(self, values: Floats) -> Arm:
        """Return the arm with other effects' numbers, its links as they were."""
        effects = list(self.arm.effects)
        for (k, name), value in zip(self.places, values[len(self.base.names) :].tolist(), strict=True):
            effects[k] = replace(effects[k], parameters={**effects[k].parameters, name: value})
        return replace(self.arm, effects=tuple(effects))


def numbers_of(arm: Arm, base: BaseParameters) -> Numbers:
    """Return all numbers of an arm: of its effects those that are set, finite and no list."""
    places = [
        (k, parameter.name)
        for k, effect in enumerate(arm.effects)
        for parameter in catalogue()[effect.name].parameters
        if not parameter.several
        and parameter.name in effect.parameters
        and not isinstance(effect.parameters[parameter.name], Sequence)
        and math.isfinite(_number(effect, parameter.name))
    ]
    return Numbers(arm, base, tuple(places))


def _number(effect: Effect, name: str) -> float:
    value = effect.parameters[name]
    assert isinstance(value, int | float)
    return float(value)
