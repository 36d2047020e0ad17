"""The numbers of an arm with effects, and its simulations for any of them.

Trials are cut into windows (multiple shooting; Bock 1983). Under a control law a trial is one window: the law
pulls the simulation back to the target. With measured torque, or none, nothing does: errors grow, without bound
where the arm can fall, so a trial is cut every ``horizon_s``. The run's time in effects is the trials' own,
``began_s + t``.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.chain import chain_of
from arm.effects.catalogue import catalogue
from arm.effects.effect_table import changed, effect_table
from arm.model import Arm, Effect, Floats
from arm.regressor import standard_parameters
from fitter.data.trial import Trial
from fitter.dynamics.shooting import Machine, Shooting
from fitter.dynamics.shooting_windows import ShootingWindow, shooting_windows


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


class ShootingWithEffects(Shooting):
    """Simulations of an arm for any of its numbers.

    Parameters
    ----------
    numbers : Numbers
    n_trial : int
        How many trials the windows are of.
    first : int
        The number of the first of them in its run, counted from 1: an effect may be there in some trials alone.
    """

    def __init__(self, numbers: Numbers, n_trial: int, first: int = 1) -> None:
        super().__init__(numbers.arm, numbers.base)
        self._numbers, self._before = numbers, chain_of(numbers.arm)
        self._which = range(first, first + n_trial)

    def machine(self, values: Floats) -> Machine:
        """Return the arm with these numbers, (n_number,); at their limits where a slope is sought beyond them."""
        values = np.clip(values, *self._numbers.bounds)
        arm = self._numbers.with_effects(values)
        inner = changed(arm)
        moved, before = self.chain(values[: len(self._numbers.base.names)]), self._before
        chain = chain_of(inner)
        # What effects change in masses and friction stays on top of what the base parameters make of these.
        chain = chain._replace(
            inertial=chain.inertial + (moved.inertial - before.inertial),
            friction=chain.friction + (moved.friction - before.friction),
        )
        # Only a list of trials makes an effect another one in each of them.
        listed = any(isinstance(value, Sequence) for effect in arm.effects for value in effect.parameters.values())
        tables = tuple(effect_table(inner, number) for number in (self._which if listed else self._which[:1]))
        return Machine(inner, chain, self._law, tables, self._which.start)


def windows(arm: Arm, trials: Sequence[Trial], step_s: float, horizon_s: float) -> list[ShootingWindow]:
    """Cut trials into windows of the angles as they were measured, for a fit.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
    step_s : float
        Step of the simulation, rounded to a whole number of samples.
    horizon_s : float
        Length of a window with measured torque or none.
    """
    return shooting_windows(arm, trials, step_s, horizon_s if arm.control.law == "measured" else np.inf)
