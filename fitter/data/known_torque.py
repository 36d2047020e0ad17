"""A torque that is known, subtracted from a trial: the residual is the torque of the rest of the arm."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fitter.data.derivatives import differentiate, lowpass
from fitter.data.trial import Floats, Trial
from limbcal.errors import DataError

#: Returns the torque (n_sample, n_joint) of a motion: of q, dq, ddq, what drives the joints, the run's time [s].
Known = Callable[[Floats, Floats, Floats, Floats, Floats], Floats]


def without_torque(trial: Trial, known: Known) -> Trial:
    """Return a trial with a known torque taken out of the one that was measured, filtered and unfiltered.

    Parameters
    ----------
    trial : Trial
    known : callable

    Raises
    ------
    DataError
        If the trial has no measured torque.
    """
    if trial.tau is None:
        raise DataError(f"{trial.name}: no torque was measured, expected columns tau1…")
    added = known(trial.q, trial.dq, trial.ddq, trial.tau, trial.began_s + trial.t)
    measured = None if trial.tau_measured is None else trial.tau_measured - added
    whole = dict(trial.whole)
    if "tau" in whole:
        whole["tau"] = whole["tau"] - _throughout(trial, known, added)
    return replace(trial, tau=trial.tau - added, tau_measured=measured, whole=whole)


def _throughout(trial: Trial, known: Known, added: Floats) -> Floats:
    """Return the known torque with the ends that were trimmed, where the motion is what the filter makes of it."""
    if trial.trimmed == 0:
        return added

    def filtered(name: str) -> Floats | None:
        return lowpass(trial.whole[name], trial.dt_s, trial.cutoff_hz) if name in trial.whole else None

    q, dq, ddq, tau = (filtered(name) for name in ("q", "dq", "ddq", "tau"))
    assert q is not None and tau is not None
    dq = differentiate(q, trial.dt_s) if dq is None else dq
    ddq = differentiate(dq, trial.dt_s) if ddq is None else ddq
    t = trial.began_s + trial.dt_s * (np.arange(len(q), dtype=np.float64) - trial.trimmed)
    found = np.array(known(q, dq, ddq, tau, t))
    found[trial.trimmed : trial.trimmed + len(added)] = added
    return found
