"""The numbers of an arm that may be moved: its base parameters by their names, its effects' by their places.

An effect's number is called as an arm file would have it: ``effect[0].coulomb_N_m``, counted from 0.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters, with_base_values
from arm.effects.catalogue import catalogue
from arm.model import Arm, Effect, Floats
from arm.regressor import standard_parameters
from limbcal.errors import ConfigError


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
    def names(self) -> tuple[str, ...]:
        """Of all numbers, (n_number,)."""
        return (*self.base.names, *(f"effect[{k}].{name}" for k, name in self.places))

    @property
    def units(self) -> tuple[str, ...]:
        """Of all numbers, (n_number,)."""
        kinds = [{p.name: p.unit for p in catalogue()[effect.name].parameters} for effect in self.arm.effects]
        return (*self.base.units, *(kinds[k][name] for k, name in self.places))

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

    def sought(self, names: Sequence[str]) -> list[int]:
        """Return the places of some numbers.

        Raises
        ------
        ConfigError
            If there is no such number.
        """
        own = self.names
        if unknown := [name for name in names if name not in own]:
            raise ConfigError(f"nothing is called {', '.join(unknown)}; expected some of {', '.join(own)}")
        return [own.index(name) for name in names]

    def with_effects(self, values: Floats) -> Arm:
        """Return the arm with other effects' numbers, its links as they were."""
        effects = list(self.arm.effects)
        for (k, name), value in zip(self.places, values[len(self.base.names) :].tolist(), strict=True):
            effects[k] = replace(effects[k], parameters={**effects[k].parameters, name: value})
        return replace(self.arm, effects=tuple(effects))

    def with_values(self, values: Floats) -> Arm:
        """Return the arm with other numbers, its links near what they were."""
        return with_base_values(self.with_effects(values), self.base, values[: len(self.base.names)])


def numbers_of(arm: Arm, base: BaseParameters) -> Numbers:
    """Return all numbers of an arm: of its effects those that are set, finite and no list."""
    places = [
        (k, parameter.name)
        for k, effect in enumerate(arm.effects)
        for parameter in catalogue()[effect.name].parameters
        if not parameter.several
        and parameter.name in effect.parameters
        and math.isfinite(_number(effect, parameter.name))
    ]
    return Numbers(arm, base, tuple(places))


def _number(effect: Effect, name: str) -> float:
    value = effect.parameters[name]
    assert isinstance(value, int | float)
    return float(value)
