"""How well a calibrated geometry reaches where the real one does (table 1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.kinematics import tip_position
from arm.model import Arm
from fitter.data.first_rest import displacement
from fitter.data.trials import Trial
from limbcal.errors import DataError


@dataclass(frozen=True)
class TipScore:
    """Errors of a calibrated arm's tip displacement, eq. (3) against r*, over some trials."""

    mean_mm: float
    max_mm: float


def tip_score(arm: Arm, trials: Sequence[Trial], about: Literal["rest", "mean"] = "rest") -> TipScore:
    """Compare where the calibrated geometry puts the tip with where it was measured.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
        With a tip.
    about : {"rest", "mean"}
        What both displacements are counted from: the trial's first rest, or their means over the trial.

    Raises
    ------
    DataError
        If there are no trials, or one has no tip.
    """
    if not trials:
        raise DataError("no trial to compare the arm with; expected at least one")
    errors = []
    for trial in trials:
        measured, rest = displacement(arm, trial)
        reached = tip_position(arm, trial.q)
        if about == "mean":
            measured, origin = measured - measured.mean(axis=0), reached.mean(axis=0)
        else:
            origin = tip_position(arm, rest).mean(axis=0)
        errors.append(1e3 * np.linalg.norm(measured - (reached - origin), axis=1))
    return TipScore(float(np.mean(np.concatenate(errors))), float(np.max(np.concatenate(errors))))
