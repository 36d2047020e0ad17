"""Motions whose controller's target nobody recorded: with the target that a calibrated arm explains them with."""

from collections.abc import Sequence

import numpy as np

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.plausibility.saturated import CONTRADICTED
from fitter.data.torque_target import target_of
from fitter.data.trial import Trial
from fitter.data.trials import to_trials
from fitter.dynamics.evaluation import torque_rms
from fitter.dynamics.fit import fit_dynamics
from limbcal.note import Note

#: What holds of every answer that rests on such motions.
HINT = "angles were tracked and targets found with the arm: their slow errors can pass for causes, a hint only"


def lacks_torque(arm: Arm, motion: Measured) -> bool:
    """Say whether nothing in a motion tells which torque the arm's control law asked for."""
    return arm.control.law != "measured" and not {"tau", "ref"} & set(motion.columns)


def with_found_targets(
    arm: Arm, learn: Sequence[Measured], evaluate: Sequence[Measured]
) -> tuple[list[Measured], list[Measured]]:
    """Return motions with targets, where the arm's control law needs some that they lack.

    The arm is calibrated with the learning motions first, as `fitter dynamics` does, and explains each motion with
    one constant target.

    Parameters
    ----------
    arm : Arm
    learn, evaluate : sequence of Measured
        Motions that have a target or a torque stay as they are.

    Raises
    ------
    DataError
        If a motion is too short or there is none to learn from.
    NotIdentifiable
        If the learning motions reveal nothing of the dynamics.
    """
    if not any(lacks_torque(arm, motion) for motion in (*learn, *evaluate)):
        return list(learn), list(evaluate)
    calibrated = fit_dynamics(arm, to_trials(learn, cutoff_hz=np.inf)).arm

    def found(motions: Sequence[Measured]) -> list[Measured]:
        complete: list[Measured] = []
        for motion in motions:
            if lacks_torque(arm, motion):
                complete += [with_target(calibrated, t, motion) for t in to_trials([motion], cutoff_hz=np.inf)]
            else:
                complete.append(motion)
        return complete

    return found(learn), found(evaluate)


def with_target(arm: Arm, trial: Trial, source: Measured | None = None) -> Measured:
    """Return a tracked motion as a file would have it: angles, and the target that the arm explains it with.

    Parameters
    ----------
    arm : Arm
        A calibrated one.
    trial : Trial
    source : Measured, optional
        What the trial was made of; None for a stream.
    """
    columns = {"q": trial.q}
    if trial.tau is not None:
        columns["tau"] = trial.tau
    elif arm.control.law != "measured":
        columns["ref"] = target_of(arm, trial)
    if trial.contradicted is not None:
        columns[CONTRADICTED] = trial.contradicted.astype(np.float64)
    std = torque_rms(arm, [trial]) if "ref" in columns and trial.ref is None else None
    where, first_row = ("stream", 0) if source is None else (source.where, source.first_row)
    start_s = trial.began_s if source is not None else 0.0
    notes = (*trial.notes, Note("hint", HINT))
    return Measured(trial.name, where, first_row, start_s + trial.t, columns, trial.role, notes, target_std=std)
