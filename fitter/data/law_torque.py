"""The torque that a law asks for in a trial, eq. (5), (6), (7), with the trial's own gains and switches."""

import numpy as np

from arm.control import control_torque
from arm.drive_state import KA, KP, KV, drives_of
from arm.model import Control, Floats
from fitter.data.derivatives import lowpass
from fitter.data.trial import Trial
from limbcal.errors import DataError


def law_torque(control: Control, trial: Trial) -> Floats:
    """Return the torque that the law asks for, behind the filter that the motion passed.

    Where gains jump, or a drive is let go, the filter smears the torque's jump as it smears that of the motion:
    the products of gains and errors are filtered, not the errors alone.

    Parameters
    ----------
    control : Control
    trial : Trial
        With a target ``ref``.

    Returns
    -------
    (n_sample, n_joint) [N m or N]

    Raises
    ------
    DataError
        If the trial has no target.
    ConfigError
        If the law is "measured", or a gain is given nowhere.
    """
    if trial.ref is None:
        raise DataError(f"trial {trial.name}: has no target; expected columns ref1…")
    motion = trial.q, trial.dq, trial.ddq
    if trial.drives is None:
        return control_torque(control, *motion, trial.ref if trial.ref_filtered is None else trial.ref_filtered)
    whole = drives_of(trial.whole)
    if trial.ref_filtered is None or whole is None:
        return trial.drives.torque(control, *motion, trial.ref)
    law, inner = whole.schedule(control), slice(trial.trimmed, trial.trimmed + len(trial.q))
    # Target and gains are held from one sample to the next, so they come half a step late as seen by the samples.
    pull, kp, kv, ka = (
        (values + np.vstack([values[:1], values[:-1]])) / 2.0
        for values in (law[:, KP] * trial.whole["ref"], law[:, KP], law[:, KV], law[:, KA])
    )
    pull = pull - kp * trial.whole["q"]
    spring, kv, ka = (lowpass(values, trial.dt_s, trial.cutoff_hz)[inner] for values in (pull, kv, ka))
    return np.asarray(spring + kv * trial.dq + ka * trial.ddq, dtype=np.float64)
