"""A trial as equations of its arm and its law, few enough to be gone over again and again."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from fitter.controller.law_columns import law_rows
from fitter.data.standstill import REST_SPEED, is_moving
from fitter.data.torque_target import motion_begins, target_holds_from
from fitter.data.trial import Trial

#: Equations are averaged over steps of about this length: the arm hardly moves in one.
STEP_S = 4e-3
#: A column that varies by less than this fraction of itself within a trial is not distinguished from an unknown
#: constant.
_CONSTANT = 1e-2


@dataclass(frozen=True)
class LawEquations:
    """Equations of one trial, averaged over short steps; `law_columns` for ``"pda"`` names the columns.

    Attributes
    ----------
    rows : (n_step, n_joint, n_column)
        As they are, an unknown target taken to be zero.
    moving : (n_step, n_joint) bool
        Which equations count: at rest, friction is undetermined.
    dt_s : float
    q, dq : (n_step, n_joint)
        The measured motion, filtered.
    ref : (n_step, n_joint), or None
        The controller's target, unfiltered.
    tau : (n_step, n_joint), or None
        The torque as it was measured, behind the filter of the rows.
    """

    rows: Floats
    moving: NDArray[np.bool_]
    dt_s: float
    q: Floats
    dq: Floats
    ref: Floats | None
    tau: Floats | None

    def counted(self, rows: Floats) -> Floats:
        """Return rows in which what does not count is zero and an unknown constant torque is taken out.

        Taking each joint's mean off is the same as fitting one more unknown for it.
        """
        moving = self.moving[..., None]
        rows = np.where(moving, rows, 0.0)
        if self.ref is not None:
            return rows
        mean = rows.sum(axis=0) / np.maximum(moving.sum(axis=0), 1)
        centred = np.where(moving, rows - mean, 0.0)
        varies = np.sum(centred**2, axis=0) > _CONSTANT**2 * np.sum(rows**2, axis=0)
        return np.asarray(centred * varies, dtype=np.float64)

    def target(self, values: Floats, kp: Floats) -> Floats:
        """Return the target, (n_step, n_joint); an unknown one is that which explains the motion best.

        Parameters
        ----------
        values : (n_column,)
        kp : (n_joint,)
        """
        if self.ref is not None:
            return self.ref
        missing = np.where(self.moving, self.rows[..., : len(values)] @ values, 0.0).sum(axis=0)
        mean = missing / np.maximum(self.moving.sum(axis=0), 1)
        safe = np.where(kp != 0.0, kp, 1.0)
        return np.tile(np.where(kp != 0.0, mean / safe, self.q.mean(axis=0)), (len(self.q), 1))


def law_equations(arm: Arm, base: BaseParameters, trial: Trial, rest_speed: float = REST_SPEED) -> LawEquations:
    """Reduce a trial to equations of its arm and its law.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity are used.
    base : BaseParameters
    trial : Trial
        Without a target, it has one constant target a joint from the start of the motion on.
    rest_speed : float [rad/s or m/s]
        A joint that is slower is at rest.
    """
    smeared = trial.ref is None and np.isfinite(trial.band_hz)
    begin = 0 if trial.ref is not None else target_holds_from(trial) if smeared else motion_begins(trial)
    q, dq, ddq = trial.q[begin:], trial.dq[begin:], trial.ddq[begin:]
    target = trial.ref if trial.ref_filtered is None else trial.ref_filtered
    rows = law_rows(arm, base, q, dq, ddq, (0.0 if target is None else target[begin:]) - q)
    if np.isfinite(trial.band_hz):
        rows = trial.lowpass(rows)
    tau = None if trial.tau is None else trial.lowpass(trial.tau[begin:])
    stride = max(1, round(STEP_S / trial.dt_s))
    moving = is_moving(dq, rest_speed)
    n = len(q) // stride * stride
    return LawEquations(
        rows=_means(rows[:n], stride),
        moving=np.asarray(moving[:n].reshape(-1, stride, arm.n_joint).all(axis=1), dtype=np.bool_),
        dt_s=stride * trial.dt_s,
        q=_means(q[:n], stride),
        dq=_means(dq[:n], stride),
        ref=None if trial.ref is None else _means(trial.ref[begin:][:n], stride),
        tau=None if tau is None else _means(tau[:n], stride),
    )


def _means(values: Floats, stride: int) -> Floats:
    return np.asarray(values.reshape(-1, stride, *values.shape[1:]).mean(axis=1), dtype=np.float64)
