"""Errors of a calibrated geometry's tip displacement (table 1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.kinematics import tip_position
from arm.model import Arm
from fitter.data.first_rest import displacement
from fitter.data.trial import Trial
from limbcal.errors import DataError


@dataclass(frozen=True)
class TipScore:
    """Errors of a calibrated arm's tip displacement, eq. (3) against r*, over some trials.

    Attributes
    ----------
    mean_mm, max_mm : float
    explained : float
        1 − power of the tip's residual displacement / power of the displacement; an arm without lengths
        explains 0. NaN where the tip does not move.
    """

    mean_mm: float
    max_mm: float
    explained: float = float("nan")


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
    errors, power = [], 0.0
    for trial in trials:
        measured, rest = displacement(arm, trial)
        reached = tip_position(arm, trial.q)
        if about == "mean":
            measured, origin = measured - measured.mean(axis=0), reached.mean(axis=0)
        else:
            origin = tip_position(arm, rest).mean(axis=0)
        errors.append(1e3 * np.linalg.norm(measured - (reached - origin), axis=1))
        power += float(np.sum(measured**2))
    off = np.concatenate(errors)
    explained = 1.0 - float(np.sum((1e-3 * off) ** 2)) / power if power > 0.0 else float("nan")
    return TipScore(float(np.mean(off)), float(np.max(off)), explained)
