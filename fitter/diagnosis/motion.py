"""Trials as a diagnosis sees them: on the run's clock, with the drive's torque, and where friction is known."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.law_torque import law_torque
from fitter.data.trials import Trial
from limbcal.errors import DataError

#: Samples a period of the corner that are kept of a motion.
SAMPLES = 5.0


@dataclass(frozen=True)
class Motion:
    """One trial of a run.

    Attributes
    ----------
    trial : Trial
    number : int
        From 1 over the run.
    learn : bool
        Whether it may be learnt from.
    t : (n_sample,) [s]
        The run's time.
    q, dq, ddq, u : (n_sample, n_joint)
        Angles, derivatives, and the torque that the drive was asked for.
    speed : (n_sample, n_joint)
        Velocity behind a filter that is quicker than that of dq: friction near rest changes within milliseconds.
    speed_noise : (n_sample, n_joint)
        Its rms noise, 0 where that is not known.
    direction : (n_sample, n_joint)
        -1, 0 or 1.
    stuck : (n_sample, n_joint) bool
        Where a joint stands still for a while: any torque up to its friction may hold it there.
    dt_s : float
        Step of its grid: `SAMPLES` a period of the columns' corner are enough.
    jumps : tuple of (float, int, float)
        Jumps of the torque: sample, joint, and the standard error of its impulse, for its instant is not known
        exactly; as the torque of one sample [N m or N].
    """

    trial: Trial
    number: int
    learn: bool
    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    u: Floats
    speed: Floats
    speed_noise: Floats
    direction: Floats
    stuck: NDArray[np.bool_]
    dt_s: float
    jumps: tuple[tuple[float, int, float], ...] = ()


def drive_torque(arm: Arm, trial: Trial) -> Floats:
    """Return the torque that the drive was asked for: measured, or by the law, eq. (5), (6), (7).

    Raises
    ------
    DataError
        If there is neither.
    """
    if trial.tau is not None:
        return trial.tau
    if arm.control.law == "measured" or trial.ref is None:
        missing = "columns tau1…, or a control law in the arm file" if trial.ref is not None else "columns tau1…"
        raise DataError(f"trial {trial.name}: nothing says which torque drove it; expected {missing}")
    return law_torque(arm.control, trial)


def sharp_torque(arm: Arm, trial: Trial) -> Floats:
    """Return the torque that was asked for with its jumps, before the column filter, ends included.

    Parameters
    ----------
    arm : Arm
    trial : Trial

    Returns
    -------
    (n_sample + 2 * trimmed, n_joint)
        Measured, or the law's for the smooth motion and the target as it was held.
    """
    if "tau" in trial.whole:
        return trial.whole["tau"]
    u = drive_torque(arm, trial)
    if trial.ref is not None and trial.drives is not None and trial.tau is None:
        u = trial.drives.torque(arm.control, trial.q, trial.dq, trial.ddq, trial.ref)
    elif trial.ref is not None and trial.ref_filtered is not None and trial.tau is None:
        u = u + np.asarray(arm.control.kp) * (trial.ref - trial.ref_filtered)
    return np.pad(u, ((trial.trimmed, trial.trimmed), (0, 0)), mode="edge")
