"""Torque that an arm with its effects leaves of what drove it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.signal

from arm.effects.effect_table import DELAY, FACTOR, LAG, LIMIT, changed, effect_table
from arm.effects.resisting_torque import resisting_torque
from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics
from fitter.data.trials import Trial
from fitter.dynamics.learned_torque import learned_torque, target_of


def torque_rms(arm: Arm, trials: Sequence[Trial], first: int = 1) -> Floats | None:
    """Return the rms of the torque that is left of what was measured, or of the law's, (n_joint,) [N m or N].

    Measured torque is taken as it was measured, unfiltered; that of a law behind the trial's filter. Where a joint
    stands still, or its drive is let go, is left out. None if nothing drove the arm.

    Parameters
    ----------
    arm : Arm
        With its effects.
    trials : sequence of Trial
    first : int
        The number of the first trial in its run, counted from 1.
    """
    square, count = np.zeros((2, arm.n_joint))
    driven, law = False, arm.control.law != "measured"
    for k, trial in enumerate(trials):
        asked = learned_torque(arm, replace(trial, ref=target_of(arm, trial)) if law else trial)
        if not law and trial.tau_measured is not None:
            asked = trial.tau_measured
        driven = driven or bool(np.any(asked))
        left = torque_left(arm, trial, asked, first + k)
        left = trial.lowpass(left) if law else left
        trim = (len(trial.q) - len(left)) // 2
        inner = slice(trim, len(trial.q) - trim)
        counts = (trial.dq[inner] != 0.0) & trial.counted[inner]
        if trial.drives is not None:
            counts &= trial.drives.on[inner]
        square += np.sum(left**2 * counts, axis=0)
        count += np.count_nonzero(counts, axis=0)
    return np.asarray(np.sqrt(square / np.maximum(count, 1.0))) if driven else None


def torque_left(arm: Arm, trial: Trial, asked: Floats, number: int) -> Floats:
    """Return the torque that arrives of what was asked for, less what the motion needs, (n_sample, n_joint).

    Parameters
    ----------
    arm : Arm
        With its effects.
    trial : Trial
    asked : (n_sample, n_joint)
    number : int
        Which of the run's trials it is, counted from 1.
    """
    inner, motion = changed(arm), (trial.q, trial.dq, trial.ddq)
    drive = effect_table(inner, number).numbers
    arrives = np.empty_like(asked)
    for j in range(arm.n_joint):
        late = np.interp(trial.t - drive[DELAY, j], trial.t, asked[:, j])
        if drive[LAG, j] > 0.0:
            keep = float(np.exp(-trial.dt_s / drive[LAG, j]))
            late = scipy.signal.lfilter([1.0 - keep], [1.0, -keep], late, zi=[keep * late[0]])[0]
        arrives[:, j] = np.clip(drive[FACTOR, j] * late, -drive[LIMIT, j], drive[LIMIT, j])
    needs = inverse_dynamics(inner, *motion)
    needs = needs + resisting_torque(arm, *motion, arrives, trial.began_s + trial.t, number)
    return np.asarray(arrives - needs, dtype=np.float64)
