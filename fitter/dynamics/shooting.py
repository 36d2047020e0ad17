"""Simulations of a window for any parameters."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from arm.base_parameters import BaseParameters
from arm.chain import Chain, chain_of
from arm.control import gains
from arm.drive import Commands
from arm.drive_state import KA, unchanging
from arm.effects.effect_table import EffectTable, no_effects
from arm.effects.joint_numbers import DELAY
from arm.integration import effect_steps
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from arm.room import make_room
from arm.way_before import set_way
from fitter.dynamics.shooting_windows import ShootingWindow

#: A simulation is fine enough if halving its step moves no angle by more than this, or this fraction of the
#: motion.
_FINE_ENOUGH = 1e-6


class Machine(NamedTuple):
    """An arm, its law and its effects, as simulations take them.

    Attributes
    ----------
    arm : Arm
        As `arm.effects.effect_table.changed` has it: what rests before the first sample is asked of it.
    chain : Chain
        Its numbers.
    law : (3, n_joint)
        kp, kv, ka, where a trial does not say its own.
    tables : tuple of EffectTable
        What acts in each trial; a single one acts in them all.
    first : int
        The number of the first trial in its run, counted from 1.
    """

    arm: Arm
    chain: Chain
    law: Floats
    tables: tuple[EffectTable, ...]
    first: int = 1


class Shooting:
    """Simulations of an arm for any base parameters.

    Parameters
    ----------
    arm : Arm
        Its geometry, law and static friction.
    base : BaseParameters
    """

    def __init__(self, arm: Arm, base: BaseParameters) -> None:
        self._arm, self._chain = arm, chain_of(arm)
        self._standard = standard_parameters(arm)
        self._combination = base.combination
        self._onto = np.linalg.pinv(base.combination)
        self._given = arm.control.law == "measured"
        self._control = arm.control
        known = not self._given and bool(arm.control.kp)
        self._law = gains(arm.control, arm.n_joint) if known else np.zeros((3, arm.n_joint))

    def machine(self, values: Floats) -> Machine:
        """Return an arm with these base parameters, any one of them: they all move alike."""
        return Machine(self._arm, self.chain(values), self._law, (no_effects(self._arm.n_joint),))

    def chain(self, values: Floats) -> Chain:
        """Return the numbers of an arm with these base parameters."""
        n = len(self._chain.revolute)
        standard = self._standard + self._onto @ (values - self._combination @ self._standard)
        friction = self._chain.friction.copy()
        friction[:, 0], friction[:, 1] = standard[10 * n : 11 * n], standard[11 * n :]
        return self._chain._replace(inertial=standard[: 10 * n].reshape(n, 10).copy(), friction=friction)

    def angles(self, machine: Machine, window: ShootingWindow, start: Floats) -> Floats:
        """Return the simulated angles of a window, (n_sample, n_joint); infinite where the arm ran away."""
        n = window.measured.shape[1]
        drive = np.tile(start[2 * n :], (len(window.drive), 1)) if window.free_target else window.drive
        table = machine.tables[min(window.trial, len(machine.tables) - 1)]
        schedule = unchanging(n) if self._given else window.schedule(self._control)
        law = schedule[0, : KA + 1] if len(schedule) else machine.law
        if not len(schedule) and not self._given:
            gains(self._control, n)  # says it if there are none
        # Loads that are taken up become part of the chain, gains and switches of the law and the table.
        chain = machine.chain._replace(inertial=machine.chain.inertial.copy())
        table = table._replace(numbers=table.numbers.copy())
        commands = Commands(law.copy(), self._given, drive, float(window.dt_s), float(window.began_s))
        room = make_room(n, len(drive) if table.numbers[DELAY].any() and not self._given else 0)
        state = start[: 2 * n].reshape(2, n).copy()
        if table.driven:
            set_way(machine.arm, commands, table, machine.first + window.trial, state, room.way)
        motion, lead = np.empty((4, *drive.shape)), np.empty((2, len(drive) if table.geared else 0, n))
        effect_steps(chain, commands, table, room, state, motion, lead, schedule)
        angles = motion[0] + lead[0] if table.geared else motion[0]
        return np.where(np.isfinite(angles), angles, np.inf)


def finest_needed(
    shooting: Shooting, cut: Callable[[float], list[ShootingWindow]], values: Floats, step_s: float
) -> float:
    """Return a step of the simulation short enough that halving it no longer matters.

    Parameters
    ----------
    shooting : Shooting
    cut : callable
        Cuts the trials for a given step.
    values : (n_base,)
    step_s : float
        Longest step to try.
    """
    machine = shooting.machine(values)
    while True:
        coarse, fine = cut(step_s)[0], cut(step_s / 2)[0]
        stride = round(coarse.dt_s / fine.dt_s)
        if stride < 2:
            return step_s
        angles = [shooting.angles(machine, window, coarse.start) for window in (coarse, fine)]
        n = min(len(angles[0]), len(angles[1][::stride]))
        off = np.abs(angles[0][:n] - angles[1][::stride][:n])
        enough = _FINE_ENOUGH * max(1.0, float(np.ptp(coarse.measured)))
        if not np.isfinite(off).all() or float(off.max()) < enough:
            return step_s
        step_s /= 2
