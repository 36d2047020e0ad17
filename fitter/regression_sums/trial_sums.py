"""A trial reduced to the sums that a fit of its torque needs."""

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.chain import chain_of
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.standstill import REST_SPEED, is_moving, throughout
from fitter.data.torque_target import has_unknown_target, target_holds_from, torque_target
from fitter.data.trial import Trial
from fitter.data.windows import forgetting_samples, windows
from fitter.regression_sums.running_sums import RunningSums
from fitter.regression_sums.torque_sums import TorqueSums, finished

#: Memory of the rows that are filtered at a time, unless the filter itself looks further.
_ROW_BYTES = 32_000_000
#: Samples whose regressor is in memory with all its columns.
_CHUNK = 2048
#: How far a filter spreads what it is given, to either side, in periods of its corner.
SPREAD = 0.35


def trial_sums(arm: Arm, base: BaseParameters, trial: Trial, rest_speed: float = REST_SPEED) -> TorqueSums:
    """Reduce a trial to the sums that a fit of its torque needs.

    Where the law's target is not known, each joint gets one of its own, fitted along, from the start of the
    motion on.

    Raises
    ------
    DataError
        If the law is "measured" and the trial has no torque.
    """
    unknown = has_unknown_target(arm, trial)
    all_of_it = slice(target_holds_from(trial) if unknown else 0, len(trial.q))
    running = RunningSums(arm.n_joint, len(base.independent), all_of_it.stop - all_of_it.start)
    add_stretch(running, arm, base, trial, all_of_it, all_of_it, rest_speed)
    sums = finished(running)
    return sums.centred() if unknown else sums


def add_stretch(
    running: RunningSums,
    arm: Arm,
    base: BaseParameters,
    trial: Trial,
    seen: slice,
    counted: slice,
    rest_speed: float = REST_SPEED,
) -> None:
    """Add samples of a trial to sums that grow; regressor and torque pass the fit's filter alike.

    Parameters
    ----------
    running : RunningSums
    arm : Arm
    base : BaseParameters
    trial : Trial
    seen, counted : slice
        What the filter sees of the trial, and what of that is added.
    rest_speed : float [rad/s or m/s]

    Raises
    ------
    DataError
        If the law is "measured" and the trial has no torque.
    """
    tau = torque_target(arm, trial)
    if not np.isfinite(trial.band_hz) and trial.contradicted is None:
        q, dq, ddq, torque = (values[counted] for values in (trial.q, trial.dq, trial.ddq, tau))
        running.add_motion(chain_of(arm), np.array(base.independent), q, dq, ddq, torque, rest_speed)
        return
    sight = forgetting_samples(trial.dt_s, trial.band_hz)
    portion = max(2 * sight, _ROW_BYTES // (8 * arm.n_joint * len(base.independent)))
    for window in windows(seen, counted, portion, sight):
        rows = filtered_rows(arm, base, trial, window.all)[window.counted]
        fast = moving_all_along(trial, window.all, rest_speed)[window.counted]
        running.add_equations(rows, trial.lowpass(tau[window.all])[window.counted], fast)


def moving_all_along(trial: Trial, part: slice, rest_speed: float) -> NDArray[np.bool_]:
    """Return which equations hold behind the fit's filter, (n_sample, n_joint).

    A joint that sticks is held by a torque of any size, and a torque that was cut off had any size: the filter
    spreads either over the moments before and after, which count as little as the moment itself.
    """
    moving = is_moving(trial.dq[part], rest_speed) & trial.counted[part]
    return throughout(moving, int(SPREAD / (trial.band_hz * trial.dt_s)))


def filtered_rows(arm: Arm, base: BaseParameters, trial: Trial, part: slice) -> Floats:
    """Return the regressor's rows behind the fit's filter, (n_sample, n_joint, n_base)."""
    rows = np.empty((part.stop - part.start, arm.n_joint, len(base.independent)))
    for begin in range(part.start, part.stop, _CHUNK):
        some = slice(begin, min(begin + _CHUNK, part.stop))
        Y = regressor(arm, trial.q[some], trial.dq[some], trial.ddq[some])
        rows[begin - part.start : some.stop - part.start] = Y[..., base.independent]
    flat = rows.reshape(len(rows), -1)
    felt = np.flatnonzero(flat.any(axis=0))  # a joint does not feel the links before it: half of them are zeros
    flat[:, felt] = trial.lowpass(flat[:, felt])
    return rows
