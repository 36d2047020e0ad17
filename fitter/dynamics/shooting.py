"""Simulations of a stretch for any base parameters."""

from collections.abc import Callable

import numpy as np

from arm.base_parameters import BaseParameters
from arm.chain import Chain, chain_of
from arm.control import gains
from arm.integration import runge_kutta_steps
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from fitter.dynamics.stretches import Stretch

#: A simulation is fine enough if halving its step moves no angle by more than this, or this share of the motion.
_FINE_ENOUGH = 1e-6


class Shooting:
    """Simulations of an arm for any base parameters.

    Parameters
    ----------
    arm : Arm
        Its geometry, law and static friction.
    base : BaseParameters
    """

    def __init__(self, arm: Arm, base: BaseParameters) -> None:
        self._chain = chain_of(arm)
        self._standard = standard_parameters(arm)
        self._combination = base.combination
        self._onto = np.linalg.pinv(base.combination)
        self._given = arm.control.law == "measured"
        self._control = arm.control
        self._law = np.zeros((3, arm.n_joint)) if self._given else gains(arm.control, arm.n_joint)

    def chain(self, values: Floats) -> Chain:
        """Return an arm with these base parameters, any one of them: they all move alike."""
        n = len(self._chain.revolute)
        standard = self._standard + self._onto @ (values - self._combination @ self._standard)
        friction = self._chain.friction.copy()
        friction[:, 0], friction[:, 1] = standard[10 * n : 11 * n], standard[11 * n :]
        return self._chain._replace(inertial=standard[: 10 * n].reshape(n, 10).copy(), friction=friction)

    def angles(self, chain: Chain, stretch: Stretch, start: Floats) -> Floats:
        """Return the simulated angles of a stretch, (n_sample, n_joint); infinite where the arm ran away."""
        n = stretch.measured.shape[1]
        drive = np.tile(start[2 * n :], (len(stretch.drive), 1)) if stretch.free_target else stretch.drive
        motion = np.empty((4, *drive.shape))
        state = start[: 2 * n].reshape(2, n).copy()
        runge_kutta_steps(
            chain, self._law, self._given, drive, stretch.dt_s, state, motion, stretch.schedule(self._control)
        )
        return np.where(np.isfinite(motion[0]), motion[0], np.inf)


def finest_needed(
    shooting: Shooting, cut: Callable[[float], list[Stretch]], values: Floats, step_s: float
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
    chain = shooting.chain(values)
    while True:
        coarse, fine = cut(step_s)[0], cut(step_s / 2)[0]
        stride = round(coarse.dt_s / fine.dt_s)
        if stride < 2:
            return step_s
        angles = [shooting.angles(chain, stretch, coarse.start) for stretch in (coarse, fine)]
        n = min(len(angles[0]), len(angles[1][::stride]))
        off = np.abs(angles[0][:n] - angles[1][::stride][:n])
        enough = _FINE_ENOUGH * max(1.0, float(np.ptp(coarse.measured)))
        if not np.isfinite(off).all() or float(off.max()) < enough:
            return step_s
        step_s /= 2
