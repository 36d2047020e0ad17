"""What may hold a joint at rest: no more than was seen to hold it, or than its friction could.

The drive's torque at a resting joint bounds the torque that may hold it: no larger than what
was seen to hold it anywhere. A joint that is asked for 1 N m, and has never been held by more than 0.01, moves at
once; unknown torques of any size next to such a start could do whatever a lag, a limit or a play does to it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.least_squares import SIGMAS
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.whitening import LASTS_S, Whitening, inner_rests


def holding_sizes(
    equations: Equations,
    weighting: Whitening,
    model: Model,
    x: Floats,
    motions: Sequence[Motion],
    allowed: float = 2.0,
) -> dict[int, Floats]:
    """Return the standard deviation of what may hold each joint, by the motions' numbers.

    It is estimated from what holds it well inside its rests, where it was seen to stand still for a while: the
    drive's torque less the arm's own. What the model's friction could hold is allowed for in any case, whatever
    that depends on: a joint that has just begun to move is not seen to, and its friction counts already.

    Parameters
    ----------
    equations : Equations
    weighting : Whitening
        By it noise is not taken for what holds a joint.
    model : Model
    x : (n_factor,)
    motions : sequence of Motion
    allowed : float
        Multiple of the largest torque that has held which is one standard deviation: more might have held.

    Returns
    -------
    mapping of int to (n_sample, n_joint) [N m or N]
        inf where it is unknown: a joint never rests for long, and its Coulomb friction was denied.
    """
    largest = np.full(equations.arm.n_joint, np.nan)
    for motion in motions:
        held = equations.residual_torque(model, x, motion)
        for j in range(len(largest)):
            for rest in inner_rests(motion.stuck[:, j], motion.dt_s):
                weight = np.hanning(min(rest.stop - rest.start, round(2.0 * LASTS_S / motion.dt_s)) + 2)[1:-1]
                weight /= weight.sum()
                seen = np.abs(np.convolve(held[rest, j], weight, "valid"))
                beyond = float(seen.max()) - SIGMAS * weighting.mean_noise(j, weight, motion.dt_s)
                largest[j] = np.fmax(largest[j], max(beyond, 0.0))
    found = {}
    for motion in motions:
        friction = friction_at_rest(equations, model, x, motion)
        unseen = np.inf if "fc" in equations.denied else allowed * friction
        found[motion.number] = allowed * np.where(np.isnan(largest), unseen, np.fmax(largest, friction))
    return found


def friction_at_rest(equations: Equations, model: Model, x: Floats, motion: Motion) -> Floats:
    """Return the friction of joints at rest, if they were about to move either way, (n_sample, n_joint) [N m].

    Parameters
    ----------
    equations : Equations
    model : Model
    x : (n_factor,)
    motion : Motion
    """
    coulomb = np.abs(equations.friction(model, x, motion)[:, 1])
    found = np.broadcast_to(coulomb, motion.q.shape)
    if not model.hypotheses:
        return found
    ways = (replace(motion, direction=np.where(motion.stuck, way, motion.direction)) for way in (1.0, -1.0))
    forward, backward = (equations.residual_torque(model, x, one) for one in ways)
    return np.asarray(np.maximum(found, 0.5 * np.abs(forward - backward)), dtype=np.float64)
