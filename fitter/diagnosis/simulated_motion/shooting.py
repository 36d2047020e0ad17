"""Windows of trials, and simulations of an arm with its effects through them (multiple shooting; Bock 1983).

Under a control law a trial is one window: the law pulls the simulation back to the target. With measured torque,
or none, nothing does: errors grow, without bound where the arm can fall, so a trial is cut every ``horizon_s``.
The run's time in effects is the trials' own, ``began_s + t``.
"""

from collections.abc import Sequence

import numpy as np

from arm.chain import chain_of
from arm.effects.effect_table import changed, effect_table
from arm.model import Arm, Floats
from fitter.data.trials import Trial
from fitter.diagnosis.simulated_motion.numbers import Numbers
from fitter.dynamics.shooting import Machine, Shooting
from fitter.dynamics.stretches import Stretch, stretches


class ShootingWithEffects(Shooting):
    """Simulations of an arm for any of its numbers.

    Parameters
    ----------
    numbers : Numbers
    n_trial : int
        How many trials the stretches are of.
    first : int
        The number of the first of them in its run, counted from 1: an effect may be there in some trials alone.
    """

    def __init__(self, numbers: Numbers, n_trial: int, first: int = 1) -> None:
        super().__init__(numbers.arm, numbers.base)
        self._numbers, self._before = numbers, chain_of(numbers.arm)
        self._which = range(first, first + n_trial)

    def machine(self, values: Floats) -> Machine:
        """Return the arm with these numbers, (n_number,)."""
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


def windows(arm: Arm, trials: Sequence[Trial], step_s: float, horizon_s: float) -> list[Stretch]:
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
    return stretches(arm, trials, step_s, horizon_s if arm.control.law == "measured" else np.inf)
