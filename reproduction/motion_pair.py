"""Two sets of motions compared: errors in numbers, and the picture of Fig. 7 and Fig. 8."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from arm.model import Arm, Floats
from arm.simulation import simulate
from fitter.data.trial import Trial
from fitter.report.figures import Comparison, draw_angles
from reproduction.bench_data import bench_trials
from reproduction.experiment import Cell

_ROLES = ("learn", "evaluate")


@dataclass(frozen=True)
class AngleErrors:
    """Mean and largest error of the joint angles [deg], of the learning and of the evaluating motions."""

    learn: tuple[float, float]
    evaluate: tuple[float, float]

    def cells(self) -> tuple[Cell, ...]:
        """Return mean and max of either as cells; what there is none of is empty."""
        return tuple(f"{x:.3f}" if np.isfinite(x) else None for pair in (self.learn, self.evaluate) for x in pair)

    def document(self) -> dict[str, object]:
        """Return the same for JSON."""
        return {role: dict(zip(("mean", "max"), getattr(self, role), strict=True)) for role in _ROLES}


def angle_errors(trials: Sequence[Trial], angles: Sequence[Floats]) -> AngleErrors:
    """Compare angles with those of some trials, sample by sample, all joints together.

    Parameters
    ----------
    trials : sequence of Trial
        With their roles.
    angles : sequence of (n_sample, n_joint) [rad]
    """
    found = []
    for role in _ROLES:
        parts = [
            np.rad2deg(np.abs(q - trial.q)).ravel()
            for trial, q in zip(trials, angles, strict=True)
            if trial.role == role
        ]
        errors = np.concatenate(parts) if parts else np.array([np.nan])
        found.append((float(errors.mean()), float(errors.max())))
    return AngleErrors(*found)


def under_the_same_control(virtual: Arm, real: Sequence[Trial], seed: int, held: bool = False) -> list[Floats]:
    """Return the angles of a virtual arm that is given the bench's targets, from its own first rest to the end.

    Nothing of the real arm's motion goes into it: it runs through all motions on its own, as section 8.2 has it;
    or, held, through each from the target before.

    Parameters
    ----------
    virtual : Arm
    real : sequence of Trial
        Motions of `bench_trials` with this seed, for their number and rate.
    seed : int
    held : bool

    Returns
    -------
    list of (n_sample, n_joint) [rad]
    """
    learning = sum(trial.role == "learn" for trial in real)
    moved = bench_trials(virtual, learning * len(real[0].t), seed, learning, len(real) - learning, held)
    return [trial.q for trial in moved]


def motion_by_motion(virtual: Arm, real: Sequence[Trial]) -> list[Floats]:
    """Return the angles of a virtual arm that begins each motion in the real arm's state."""
    angles = []
    for trial in real:
        assert trial.ref is not None
        angles.append(simulate(virtual, trial.ref, trial.dt_s, trial.q[0], trial.dq[0]).q)
    return angles


def picture_of(real: Sequence[Trial], angles: Sequence[Floats], labels: tuple[str, str]) -> Figure:
    """Draw all motions, both sets of angles, one after the other."""
    turning = (True,) * real[0].q.shape[1]
    thin = max(1, round(0.01 / real[0].dt_s))  # a hundred points a second are more than the picture shows
    pairs = [
        Comparison(trial.name, trial.role != "evaluate", trial.t[::thin], trial.q[::thin], q[::thin], turning)
        for trial, q in zip(real, angles, strict=True)
    ]
    return draw_angles(pairs, labels)
