"""How far bodies are from satisfying the six base equations: the table's, and those that were learnt."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.chain import chain_of
from arm.model import Arm, Floats
from fitter.ground.floating_base import N_FREE, FloatingBase, along_joints
from fitter.ground.frequency_rows import frequency_rows
from fitter.ground.ground_trial import GroundTrial
from fitter.ground.plate_calibration import PlateCalibration
from limbcal.note import Note


@dataclass(frozen=True)
class GroundScore:
    """Residuals of a set of trials, up to the fit's corner.

    Attributes
    ----------
    force_rms_N, moment_rms_N_m : tuple of float
        Of the vectors, with the arm's own bodies, with those that were learnt, and with the plates' learnt errors
        beside these; about the base link's origin.
    joint_rms, explained : (6,)
        Of the base's joints with the learnt bodies: rms of the generalised force left [N, N m], and the share of
        its power that is explained.
    """

    force_rms_N: tuple[float, float, float]
    moment_rms_N_m: tuple[float, float, float]
    joint_rms: Floats
    explained: Floats

    def document(self) -> dict[str, object]:
        """Return what stands in a JSON document under ``ground_residual``."""
        before, after, with_plates = (
            {"force_rms_N": force, "moment_rms_N_m": moment}
            for force, moment in zip(self.force_rms_N, self.moment_rms_N_m, strict=True)
        )
        return {
            "before": before,
            "after": after,
            "squared_reduction": self.squared_reduction(1),
            "with_plates": {**with_plates, "squared_reduction": self.squared_reduction(2)},
        }

    def squared_reduction(self, of: int) -> dict[str, float]:
        """Return by which share the squared residuals fall: 1 for the bodies, 2 for bodies and plates."""
        return {
            "force": 1.0 - (self.force_rms_N[of] / self.force_rms_N[0]) ** 2,
            "moment": 1.0 - (self.moment_rms_N_m[of] / self.moment_rms_N_m[0]) ** 2,
        }


def ground_score(
    arm: Arm,
    base: FloatingBase,
    trials: Sequence[GroundTrial],
    before: Floats,
    after: Floats,
    plates: PlateCalibration,
    band_hz: float,
) -> GroundScore:
    """Judge bodies on trials.

    Parameters
    ----------
    arm : Arm
    base : FloatingBase
    trials : sequence of GroundTrial
    before, after : (10 n_body,)
        Standard parameters.
    plates : PlateCalibration
        Learnt beside ``after``.
    band_hz : float
    """
    slides = [not bool(chain_of(arm).revolute[i]) for i in base.joints]
    n = sum(len(trial.t) for trial in trials)
    squares, joint, measured = np.zeros((2, 3)), np.zeros(N_FREE), np.zeros(N_FREE)
    for trial in trials:
        left = [trial.wrench - trial.Y @ theta for theta in (before, after)]
        left.append(left[1] - plates.wrench(trial.wrench))
        free = [trial.motions[i] for i in base.joints]
        along = [along_joints(wrench, free, slides) for wrench in (left[1], trial.wrench)]
        columns = np.stack([*left, *along], axis=2)
        power = np.sum(frequency_rows([columns], [trial.wrench], [trial.dt_s], band_hz).Y ** 2, axis=0)
        squares += np.array([power[:3, :3].sum(axis=0), power[3:, :3].sum(axis=0)])
        joint, measured = joint + power[:, 3], measured + power[:, 4]
    force, moment = np.sqrt(squares / n).tolist()
    return GroundScore(
        (force[0], force[1], force[2]),
        (moment[0], moment[1], moment[2]),
        np.sqrt(joint / n),
        1.0 - joint / np.maximum(measured, 1e-300),
    )


def worse_than_nothing(base: FloatingBase, scores: Mapping[str, GroundScore | None]) -> tuple[Note, ...]:
    """Return a note for each component of the ground's wrench that the bodies predict worse than zero would.

    Parameters
    ----------
    base : FloatingBase
    scores : mapping of str to GroundScore or None
        By role, ``learn`` and ``evaluate``.
    """
    return tuple(
        Note(
            "unexplained",
            f"along joint {i + 1} the learnt bodies predict the ground's reaction in the {title} trials worse "
            f"than zero would (the residual has {100.0 * (1.0 - share):.0f} % of its power): hardly anything of "
            "it is the body's motion, or the plates' zero or place or the base's angles are off there",
            columns=(f"q{i + 1}",),
        )
        for role, title in (("learn", "learning"), ("evaluate", "evaluating"))
        if (score := scores.get(role)) is not None
        for i, share in zip(base.joints, score.explained.tolist(), strict=True)
        if share < 0.0
    )
