"""Which torque a trial is explained with: the measured one, or what a control law asks for (section 6.2)."""

import numpy as np

from arm.control import control_torque, gains
from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics
from fitter.data.derivatives import settling_samples
from fitter.data.law_torque import law_torque
from fitter.data.trial import Trial
from limbcal.errors import DataError

#: A motion has begun where a joint is this fast, as a share of its top speed in the trial.
_BEGUN = 0.05
#: Samples from the first that a motion may begin in to one that it surely does not begin in.
_AVERAGED = 2


def has_unknown_target(arm: Arm, trial: Trial) -> bool:
    """Say whether the law of the arm needs a target that the trial does not determine."""
    return arm.control.law != "measured" and trial.ref is None


def torque_target(arm: Arm, trial: Trial) -> Floats:
    """Return the torque of a trial: measured, or by eq. (5), (6), (7).

    Where the target is not known it is taken to be zero: for a point-to-point motion the torque that is
    missing is then one constant a joint, ``kp`` times the target.

    Returns
    -------
    (n_sample, n_joint) [N m or N]

    Raises
    ------
    DataError
        If the law is "measured" and the trial has no torque, or the trial's own gains want for a target.
    ConfigError
        If the law lacks gains.
    """
    if arm.control.law == "measured":
        if trial.tau is None:
            raise DataError(
                f"trial {trial.name}: has no torque, but control.law of arm {arm.name} is 'measured'; "
                "expected columns tau1…, or a control law"
            )
        return trial.tau
    if trial.ref is not None:
        return law_torque(arm.control, trial)
    if trial.drives is not None:
        raise DataError(
            f"trial {trial.name}: has gains or switches of its own and no target; expected columns ref1…"
        )
    return control_torque(arm.control, trial.q, trial.dq, trial.ddq, np.zeros_like(trial.q))


def motion_begins(trial: Trial) -> int:
    """Return the sample at which a trial leaves its first rest; before it, the target was where it stood.

    `fitter.data.first_rest` ends as soon as anything may move, so that a rest is surely one; here the instant
    itself is asked for, so it is reckoned back from where a share of the top speed is reached.
    """
    speed = np.abs(trial.dq)
    fast = speed > _BEGUN * np.max(speed, axis=0, initial=0.0)
    samples = np.flatnonzero(fast.any(axis=1))
    if not len(samples):
        return 0
    first = int(samples[0])
    joint = int(np.argmax(fast[first]))
    if trial.ddq[first, joint] == 0.0:
        return first
    since = trial.dq[first, joint] / trial.ddq[first, joint] / trial.dt_s  # as if from rest, evenly
    return int(np.clip(np.ceil(first - since), 0, first)) if since > 0.0 else first


def target_holds_from(trial: Trial) -> int:
    """Return the sample from which on an unknown target surely is one constant.

    A filter smears the motion's start over its own settling time, to either side; a tracker that averages readings
    over a step, over the step that the start lies in, which is known to a step.
    """
    settling = 0 if trial.draws is None else _AVERAGED
    if np.isfinite(trial.cutoff_hz):
        settling = settling_samples(trial.dt_s, trial.cutoff_hz)
    begin = motion_begins(trial)
    return begin + settling if begin + settling < len(trial.q) // 2 else begin


def start_unknown(arm: Arm, trial: Trial) -> slice:
    """Return the samples that were averaged from readings before and after an unknown target began to act.

    No torque goes with them. A filter, which smears torque and motion alike, leaves none of them.
    """
    begin, averaged = motion_begins(trial), trial.draws is not None and has_unknown_target(arm, trial)
    return slice(begin, target_holds_from(trial) if averaged else begin)


def target_of(arm: Arm, trial: Trial) -> Floats:
    """Return the controller's target: the trial's own, or the one that explains its motion best.

    Parameters
    ----------
    arm : Arm
        A calibrated one, with a control law.
    trial : Trial
        Where it has no ``ref`` it is a point-to-point motion: one target from the start of the motion on.

    Returns
    -------
    (n_sample, n_joint) [rad or m]
    """
    if trial.ref is not None:
        return trial.ref
    unknown = start_unknown(arm, trial)
    start, known = unknown.start, slice(unknown.stop, None)
    kp = gains(arm.control, arm.n_joint)[0]
    missing = inverse_dynamics(arm, trial.q, trial.dq, trial.ddq) - torque_target(arm, trial)
    target = np.tile(trial.q[:start].mean(axis=0) if start else trial.q[0], (len(trial.q), 1))
    moving = (trial.dq[known] != 0.0) & trial.counted[known]
    mean = np.sum(missing[known] * moving, axis=0) / np.maximum(np.count_nonzero(moving, axis=0), 1)
    target[start:] = np.where(kp != 0.0, mean / np.where(kp != 0.0, kp, 1.0), target[start:])
    return target
