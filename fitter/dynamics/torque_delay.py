"""A torque that comes late: how far its column must be moved for the arm to explain it best."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.standstill import is_moving
from fitter.data.trial import Trial
from limbcal.note import Note

#: Delays are sought up to this long [s]: filters of drives and buses stay below.
_LONGEST_S = 0.05
#: Samples of a trial that are enough to tell a delay.
_SAMPLES = 1500
#: A delay is believed from this log likelihood ratio on: a chi-square of one degree of freedom, p = 10⁻⁴.
_BELIEVED = 7.57


@dataclass(frozen=True)
class Delay:
    """A torque's delay against the motion.

    Attributes
    ----------
    seconds : float
        Above zero where the torque comes late.
    residual_share : float
        Share of the residual as given that remains with the delay put right, 0..1.
    """

    seconds: float
    residual_share: float

    @property
    def note(self) -> Note:
        """What to say of it."""
        how = "late" if self.seconds > 0.0 else "early"
        less = 100.0 * (1.0 - self.residual_share)
        said = (
            f"the torque comes {1e3 * abs(self.seconds):.3g} ms {how}: with it moved, "
            f"{less:.2g} % less of the torque is left; was it filtered, or logged on "
            "another clock? It was not moved, and parameters may be several standard errors off"
        )
        return Note("late", said, columns=("tau",))


def torque_delay(arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> Delay | None:
    """Return a measured torque's delay where there is one of at least a sample.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity.
    base : BaseParameters
    trials : sequence of Trial
        With a measured torque; their own filters are zero phase and delay nothing.

    Returns
    -------
    Delay or None
        None too where the first and the second half of the motion do not tell the same delay to a step: what a
        model lacks is fitted by some delay, but by another one in another motion.
    """
    whole = _best(arm, base, trials)
    if whole is None:
        return None
    halves = [_best(arm, base, trials, half) for half in (0, 1)]
    step_s = max(trial.dt_s for trial in trials)
    if any(half is None or abs(half.seconds - whole.seconds) > 1.5 * step_s for half in halves):
        return None
    return whole


def _best(arm: Arm, base: BaseParameters, trials: Sequence[Trial], half: int | None = None) -> Delay | None:
    if arm.control.law != "measured" or not trials or any(trial.tau is None for trial in trials):
        return None
    step_s = float(np.median([trial.dt_s for trial in trials]))
    most = int(_LONGEST_S / step_s)
    if most < 1:
        return None
    shifts = np.unique(np.round(np.concatenate([np.linspace(-most, most, 21), [-1, 0, 1]])).astype(int))
    parts = [_rows(arm, base, trial, most, half) for trial in trials]
    W = np.vstack([rows for rows, _, _ in parts])
    if len(W) <= W.shape[1] + 2:
        return None
    Q = np.linalg.qr(W)[0]

    def residual_of(shift: int) -> tuple[float, Floats]:
        tau = np.concatenate([trial_tau[at + shift].ravel() for _, at, trial_tau in parts])
        residual = tau - Q @ (Q.T @ tau)
        return float(residual @ residual), residual

    as_given, residual = residual_of(0)
    found = {int(shift): residual_of(int(shift))[0] for shift in shifts}
    best = min(found, key=lambda shift: found[shift])
    for shift in range(best - most // 10, best + most // 10 + 1):
        if -most <= shift <= most and shift not in found:
            found[shift] = residual_of(shift)[0]
    best = min(found, key=lambda shift: found[shift])
    if best == 0 or not as_given > 0.0:
        return None
    rows = residual.reshape(-1, arm.n_joint)
    alike = float(np.sum(rows[1:] * rows[:-1]) / max(np.sum(rows**2), 1e-300))
    effective = len(residual) * (1.0 - max(alike, 0.0)) / (1.0 + max(alike, 0.0))
    if 0.5 * effective * np.log(as_given / max(found[best], 1e-300)) < _BELIEVED or abs(best) == most:
        return None
    return Delay(best * step_s, found[best] / as_given)


def _rows(
    arm: Arm, base: BaseParameters, trial: Trial, most: int, half: int | None
) -> tuple[Floats, NDArray[np.intp], Floats]:
    """Return some equations of a trial, the samples they are of, and its torque."""
    moving = np.asarray((is_moving(trial.dq) & trial.counted).all(axis=1))
    moving[:most] = moving[len(moving) - most :] = False
    if half is not None:
        moving[: len(moving) // 2] &= half == 0
        moving[len(moving) // 2 :] &= half == 1
    at = np.flatnonzero(moving)[:: max(1, len(trial.q) // _SAMPLES)]
    Y = regressor(arm, trial.q[at], trial.dq[at], trial.ddq[at])[..., base.independent]
    assert trial.tau is not None
    return Y.reshape(-1, Y.shape[-1]), at, trial.tau
