"""A trial reduced to the sums that a fit of its torque needs."""

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm
from arm.regressor import regressor
from fitter.data.first_rest import REST_SPEED
from fitter.data.trials import Trial
from fitter.dynamics.learned_torque import has_unknown_target, learned_torque, motion_begins
from fitter.dynamics.torque_sums import TorqueSums, row_sums, torque_sums


def trial_sums(arm: Arm, base: BaseParameters, trial: Trial, rest_speed: float = REST_SPEED) -> TorqueSums:
    """Reduce a trial to the sums that a fit of its torque needs.

    Where the law's target is not known, each joint gets one of its own, fitted along, from the start of the
    motion on.

    Raises
    ------
    DataError
        If the law is "measured" and the trial has no torque.
    """
    tau = learned_torque(arm, trial)
    unknown = has_unknown_target(arm, trial)
    moving = slice(motion_begins(trial) if unknown else 0, None)
    q, dq, ddq, tau = trial.q[moving], trial.dq[moving], trial.ddq[moving], tau[moving]
    if np.isfinite(trial.band_hz):
        rows = trial.lowpass(regressor(arm, q, dq, ddq)[..., base.independent])
        trim = (len(q) - len(rows)) // 2
        fast = np.abs(dq[trim : len(q) - trim]) > rest_speed
        sums = row_sums(rows, trial.lowpass(tau), fast)
    else:
        sums = torque_sums(arm, base, q, dq, ddq, tau, rest_speed)
    return sums.centred() if unknown else sums
