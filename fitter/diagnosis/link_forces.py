"""What moves a link on which no motor pulls, by a fitted model."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.contacts import BESIDE_S
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.free_link import FreeLink
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.motion import HypotheticalMotion, Motion


def free_link(equations: Equations, candidate: Candidate, motion: Motion, joint: int) -> FreeLink | None:
    """Return what moves a link by a model; None where the model gives it no inertia.

    Parameters
    ----------
    equations : Equations
    candidate : Candidate
        The model. What it says of the link's motion while its motor crosses hardly matters: only the velocities
        of the joints and their places enter, and the accelerations of the other ones.
    motion : Motion
    joint : int
    """
    model, x = candidate.model, candidate.x
    hypothetical = equations.hypothetical(model, motion)
    asked = _asked(equations, hypothetical, x, joint)
    pushed = replace(hypothetical, ddq=hypothetical.ddq + np.eye(motion.q.shape[1])[joint])
    inertia = _asked(equations, pushed, x, joint) - asked
    if not np.all(inertia > 0.0):
        return None
    viscous, coulomb = np.maximum(equations.friction(model, x, motion)[joint], 0.0)
    ddq, dq, direction = (one[:, joint] for one in (hypothetical.ddq, hypothetical.dq, hypothetical.direction))
    resistance = asked - inertia * ddq - viscous * dq - coulomb * direction
    residual = equations.residual_torque(model, x, motion)[:, joint]
    lacking = _steady(residual, ~motion.unknown[:, joint], max(1, round(BESIDE_S / motion.dt_s)))
    return FreeLink(motion.t, inertia, resistance, float(viscous), float(coulomb), lacking)


def _steady(residual: Floats, known: NDArray[np.bool_], n: int) -> float:
    """Return the rms of a residual's means over n samples each, of those that are known."""
    whole = len(residual) // n * n
    blocks, counts = residual[:whole].reshape(-1, n), known[:whole].reshape(-1, n)
    full = np.all(counts, axis=1)
    return float(np.sqrt(np.mean(blocks[full].mean(axis=1) ** 2))) if np.any(full) else np.inf


def _asked(equations: Equations, hypothetical: HypotheticalMotion, x: Floats, joint: int) -> Floats:
    """Return the torque that a motion asks of a joint, (n_sample,), for a drive with a gain of 1."""
    known = hypothetical.u - hypothetical.target(equations.known)
    asked = known + hypothetical.equations(equations.independent(hypothetical.arm)) @ x
    return np.asarray(asked[:, joint] / hypothetical.factor[joint], dtype=np.float64)
