"""What every trial of a diagnosed run leaves, in torque and in motion, before and after."""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.diagnosis.held_out import smooth, torque_residual
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import Motion

#: A simulation that is this far out has run away [rad or m].
_RUNAWAY = 1e3


@dataclass(frozen=True)
class Trace:
    """What a trial leaves.

    Attributes
    ----------
    motion : Motion
        Not thinned.
    residuals : list of (n_sample, n_joint)
        Torque that the model leaves, without and with the causes (only the former where none was accepted), smooth
        as far as the noise lets it be seen; NaN while the joint is stuck.
    simulated : list of (n_sample, n_joint)
        Angles of the simulation, likewise; empty for trials that were learnt from.
    """

    motion: Motion
    residuals: list[Floats]
    simulated: list[Floats]

    @property
    def torque_square(self) -> float:
        """chi2 without the causes."""
        return float(np.nansum(self.residuals[0] ** 2))

    @property
    def angle_error(self) -> float:
        """Largest error of a simulated angle without the causes."""
        error = np.abs(self.simulated[0] - self.motion.trial.q)
        return float(np.max(np.where(np.isfinite(error), error, np.inf)))


def traces(found: Diagnosis) -> list[Trace]:
    """Return what every trial of a run leaves, and the motion that is simulated of the evaluating ones."""
    models: list[Candidate] = [found.search.base]
    errors = [found.finding.before]
    if found.final is not found.search.base:
        models.append(found.final)
        errors.append(found.finding.after)
    seen_hz = found.regression.weighting.seen_hz
    simulated = zip(*(error.simulated for error in errors), strict=True)
    listed = []
    for motion in found.motions:
        residuals = [torque_residual(found.regression, model, motion) for model in models]
        residuals = [smooth(one, motion.dt_s, seen_hz) for one in residuals]
        angles = [] if motion.learn else [_kept(one) for one in next(simulated)]
        listed.append(Trace(motion, residuals, angles))
    return listed


def _kept(angles: Floats) -> Floats:
    """Return simulated angles, NaN from where they ran away and would leave nothing else to be seen."""
    gone = np.logical_or.accumulate(~(np.abs(angles) < _RUNAWAY), axis=0)
    return np.where(gone, np.nan, angles)


def turns(found: Diagnosis, joint: int) -> bool:
    """Say whether a joint (from 0) is revolute."""
    return found.regression.arm.joints[joint].type == "revolute"


def unit_of(found: Diagnosis, joint: int) -> str:
    """Return the unit of a joint's torque or force."""
    return "N m" if turns(found, joint) else "N"
