"""The rest that a trial begins with: where displacements are counted from."""

import numpy as np

from arm.model import Arm, Floats
from fitter.data.standstill import is_moving
from fitter.data.trial import Trial
from limbcal.errors import DataError


def first_rest(trial: Trial) -> slice:
    """Return the samples at the start of a trial in which no joint moves, the very first one at least."""
    moving = np.flatnonzero(is_moving(trial.dq).any(axis=1))
    return slice(0, max(1, int(moving[0]) if len(moving) else len(trial.q)))


def displacement(arm: Arm, trial: Trial) -> tuple[Floats, Floats]:
    """Return how far the tip has come since the first rest, and the joint angles at that rest.

    Returns
    -------
    displacement : (n_sample, 3) [m]
    rest : (n_rest, n_joint) [rad or m]

    Raises
    ------
    DataError
        If the trial has no tip, or not the arm's joints.
    """
    if trial.tip is None:
        raise DataError(f"trial {trial.name}: has no tip; expected columns tipx, tipy and tipz")
    if trial.q.shape[1] != arm.n_joint:
        raise DataError(f"trial {trial.name}: has {trial.q.shape[1]} joints, arm {arm.name} has {arm.n_joint}")
    rest = first_rest(trial)
    return trial.tip - trial.tip[rest].mean(axis=0), trial.q[rest]
