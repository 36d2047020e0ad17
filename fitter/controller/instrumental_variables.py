"""Columns of a law's equation without noise: those of a simulated motion."""

import numpy as np

from arm.base_parameters import BaseParameters
from arm.drive_state import unchanging
from arm.integration import runge_kutta_steps
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.controller.law_columns import LawColumns, law_rows
from fitter.controller.law_equations import LawEquations
from fitter.dynamics.shooting import Shooting

#: Lengths of simulations [s], tried in this order: long ones depend least on the measured motion, short ones stay
#: near it.
_LENGTHS_S = (np.inf, 2.0, 0.5)
#: Largest rms error of simulated angles, in standard deviations of the measured ones, at which a length is taken.
_NEAR = 0.1
#: Least share of samples within one such standard deviation, or the simulation is rejected as a whole.
_LEAST_VALID = 0.5


class InstrumentalVariables:
    """Columns of the simulated motions of an arm, for any base parameters and gains.

    Parameters
    ----------
    arm : Arm
        Its geometry and static friction.
    base : BaseParameters
    columns : LawColumns
        What the values are.
    """

    def __init__(self, arm: Arm, base: BaseParameters, columns: LawColumns) -> None:
        self._arm, self._base, self._columns = arm, base, columns
        self._shooting = Shooting(arm, base)

    def possible(self, values: Floats, q: Floats) -> bool:
        """Say whether an arm and its law have positive inertia, ``M - ka``, at some joint angles, (n, n_joint).

        Where they don't, a simulation runs away at once.
        """
        n, still = self._arm.n_joint, np.zeros_like(q)
        p = values[: self._columns.n_base]
        inertia = np.empty((len(q), n, n))
        weight = regressor(self._arm, q, still, still)[..., self._base.independent] @ p
        for j in range(n):
            unit = still.copy()
            unit[:, j] = 1.0
            inertia[..., j] = regressor(self._arm, q, still, unit)[..., self._base.independent] @ p - weight
        inertia -= np.diag(self._columns.law_table(values)[2])
        return bool(np.isfinite(inertia).all() and np.linalg.eigvalsh(inertia).min() > 0.0)

    def rows(self, values: Floats, equations: LawEquations) -> Floats:
        """Return the columns of a trial's simulated motion, (n_step, n_joint, n_column).

        They count where the trial's equations do, and where the simulation did not run away; all are zero where
        it mostly did.
        """
        n = len(self._columns.names)
        law = self._columns.law_table(values)
        target = equations.target(values, law[0])
        spread = np.std(equations.q, axis=0) + 1e-300
        for length_s in _LENGTHS_S:
            motion = self._motion(values, law, equations, target, length_s)
            off = np.abs(motion[0] - equations.q) / spread
            sane = np.isfinite(motion).all(axis=(0, 2)) & (off < 1.0).all(axis=1)
            if sane.all() and np.all(np.sqrt(np.mean(off**2, axis=0)) < _NEAR):
                break
        if np.mean(sane) < _LEAST_VALID:
            sane[:] = False
        q, dq, ddq = np.where(sane[:, None], motion[:3], 0.0)
        rows = law_rows(self._arm, self._base, q, dq, ddq, target - q)[..., :n]
        return equations.counted(np.where(sane[:, None, None], rows, 0.0))

    def _motion(
        self, values: Floats, law: Floats, equations: LawEquations, target: Floats, length_s: float
    ) -> Floats:
        chain = self._shooting.chain(values[: self._columns.n_base])
        n = len(target)
        steps = n if np.isinf(length_s) else max(2, round(length_s / equations.dt_s))
        motion = np.empty((4, *target.shape))
        for first in range(0, n, steps):
            part = np.ascontiguousarray(target[first : first + steps])
            out = np.empty((4, *part.shape))
            state = np.array([equations.q[first], equations.dq[first]])
            runge_kutta_steps(chain, law, False, part, equations.dt_s, state, out, unchanging(len(state[0])))
            motion[:, first : first + steps] = out
        return motion
