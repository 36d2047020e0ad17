"""Eq. (9) with each joint in units of its own noise, and with outliers taken for what they are.

Huber's estimate by pseudo-values (Huber 1981, section 7.8): a torque that is off by more than the bend is replaced
by one that is off by just the bend, and least squares are done again until nothing changes. The pseudo-values pass
the filter of a fit and go into its sums as any torque does.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.control import control_torque
from arm.model import Arm, Control, Floats
from arm.regressor import regressor
from fitter.data.derivatives import lowpass
from fitter.data.standstill import REST_SPEED, is_moving
from fitter.data.torque_target import has_unknown_target, torque_target
from fitter.data.trial import Trial
from fitter.regression_sums.torque_sums import TorqueSums, add_up
from fitter.regression_sums.trial_sums import trial_sums
from limbcal.errors import ConfigError

#: Tuning constant of Huber's M-estimator [standard deviations]: 95 % efficiency on normal residuals (Huber 1981).
HUBER_SIGMAS = 1.345
_MAD_OF_NORMAL = 0.6745
#: Samples of one trial whose regressor is held in memory at a time.
_CHUNK = 20_000


def weighted(sums: TorqueSums, values: Floats) -> TorqueSums:
    """Return sums in which every joint counts by one over its residual's mean square.

    Weights are normalised, so that sums of squares stay in the unit of the best joint.

    Parameters
    ----------
    sums : TorqueSums
    values : (n_base,)
        Parameters of an earlier fit, whose residual it is.
    """
    rms = np.maximum(sums.rms(values), 1e-12 * max(float(np.sqrt(sums.power.sum())), 1e-300))
    return _scaled(sums, (rms.min() / rms) ** 2)


@dataclass(frozen=True)
class Pseudo:
    """Trials whose outlying torques were drawn in.

    Attributes
    ----------
    sums : TorqueSums
        Of the pseudo-values, joints weighted.
    scale : (n_joint,) [N m or N]
        Spread of the residual, from its median; infinite where a joint never moves.
    bent : (n_joint,)
        Share of the moving samples that were drawn in.
    """

    sums: TorqueSums
    scale: Floats
    bent: Floats


def draw_in(
    arm: Arm, base: BaseParameters, trials: Sequence[Trial], values: Floats, rest_speed: float = REST_SPEED
) -> Pseudo:
    """Draw outlying torques in towards a fit; a joint that never moves has no weight.

    Parameters
    ----------
    arm : Arm
    base : BaseParameters
    trials : sequence of Trial
    values : (n_base,)
        The fit so far.
    rest_speed : float [rad/s or m/s]
        A joint this slow is taken to be at rest.

    Raises
    ------
    ConfigError
        If the target of a trial is not known: its constant torque is then no outlier but unknown.
    """
    if any(has_unknown_target(arm, trial) for trial in trials):
        raise ConfigError("the robust objective needs the controller's target; expected columns ref1…")
    torques = [torque_samples(arm, trial) for trial in trials]
    models = [np.concatenate(list(_model(arm, base, trial, values))) for trial in trials]
    residual = np.concatenate([tau - model for tau, model in zip(torques, models, strict=True)])
    counts = np.concatenate([is_moving(trial.dq, rest_speed) & trial.counted for trial in trials])
    scale = np.array([_spread(residual[counts[:, j], j]) for j in range(arm.n_joint)])
    measured = replace(arm, control=Control())
    drawn = []
    for trial, tau, model in zip(trials, torques, models, strict=True):
        pseudo = model + np.clip(tau - model, -HUBER_SIGMAS * scale, HUBER_SIGMAS * scale)
        drawn.append(trial_sums(measured, base, replace(trial, tau=_filtered(trial, pseudo)), rest_speed))
    sums = _scaled(add_up(drawn), (scale.min() / scale) ** 2)
    bent = np.count_nonzero((np.abs(residual) > HUBER_SIGMAS * scale) & counts, axis=0)
    return Pseudo(sums, scale, np.asarray(bent / np.maximum(np.count_nonzero(counts, axis=0), 1)))


def _spread(residual: Floats) -> float:
    """Return the standard deviation of what is normal but for some outliers; of nothing it is infinite."""
    return max(float(np.median(np.abs(residual))) / _MAD_OF_NORMAL, 1e-12) if len(residual) else np.inf


def torque_samples(arm: Arm, trial: Trial) -> Floats:
    """Return the torque of every sample as it was before any filter, measured or by the law."""
    if arm.control.law == "measured":
        return torque_target(arm, trial) if trial.tau_measured is None else trial.tau_measured
    inner = slice(trial.trimmed, len(trial.q) + trial.trimmed)
    q = trial.whole["q"][inner] if "q" in trial.whole else trial.q
    ref = trial.q if trial.ref is None else trial.ref
    if trial.drives is not None:
        return trial.drives.torque(arm.control, q, trial.dq, trial.ddq, ref)
    return control_torque(arm.control, q, trial.dq, trial.ddq, ref)


def _model(arm: Arm, base: BaseParameters, trial: Trial, values: Floats) -> Iterator[Floats]:
    for start in range(0, len(trial.q), _CHUNK):
        part = slice(start, start + _CHUNK)
        rows = regressor(arm, trial.q[part], trial.dq[part], trial.ddq[part])[..., base.independent]
        yield np.asarray(rows @ values, dtype=np.float64)


def _filtered(trial: Trial, tau: Floats) -> Floats:
    """Pass a torque through the filter that the trial's columns passed."""
    return lowpass(tau, trial.dt_s, trial.cutoff_hz) if trial.whole and np.isfinite(trial.cutoff_hz) else tau


def _scaled(sums: TorqueSums, weight: Floats) -> TorqueSums:
    return replace(
        sums,
        gram=sums.gram * weight[:, None, None],
        moment=sums.moment * weight[:, None],
        power=sums.power * weight,
    )
