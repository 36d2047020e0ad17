"""Static friction: a joint at rest is held by more than ever resists it while it moves.

The equations of a stuck joint tell nothing of the arm, and are eliminated from every fit (`equation`). They do
tell what holds the joint: the drive's torque less the arm's own. Coulomb friction holds up to its own level;
whatever holds more is the paper's F.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Arm, Effect, Floats
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, NEGLIGIBLE, SIGMAS
from fitter.diagnosis.model import Candidate
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.whitening import inner_rests
from fitter.search.fitted_parameter import FittedParameter

#: What it is called.
EFFECT = "stiction"

#: Half width of the 95 % interval of F, relative to the largest torque that has held: F lies between that torque
#: and 1.4 times it.
_MORE = 0.2
#: Ratio of the estimate of F, the middle of that interval, to the largest torque that has held.
ABOVE = 1.0 + _MORE


@dataclass(frozen=True)
class Holding:
    """Static friction of one joint.

    Attributes
    ----------
    joint : int
        From 0.
    parameter : FittedParameter
        F, the most that has held it [N m or N].
    gain : float
        Share of the squared torque beyond Coulomb friction, in the evaluating trials' rests, that the learning
        trials' F allows for.
    """

    joint: int
    parameter: FittedParameter
    gain: float


def holdings(regression: Regression, final: Candidate, covariance: Floats) -> list[Holding]:
    """Return the joints that stick, and at what torque.

    The largest torque that has held is a lower bound: how much more would have held is not known unless something
    is torn away slowly. F is told as a fifth above it, and 95 % reach from it to almost half as much again.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        The model with all causes.
    covariance : (n_factor + n_psi, n_factor + n_psi)
        Of what was learnt: where the arm's own torque at rest is not known well, a rest tells little.
    """
    known = np.nan_to_num(covariance)
    unit = catalogue()[EFFECT].parameters[0].unit
    if any(one.kind.place == "transmission" for one in final.model.hypotheses):
        return []  # what the links do at rest is not seen
    friction = regression.equations.friction(final.model, final.x, regression.motions[0])[:, 1]
    found = []
    for j in range(regression.arm.n_joint):
        if any(one.kind.holds and j in one.joints for one in final.model.hypotheses):
            continue
        coulomb = abs(float(friction[j]))
        sets = [_held(regression, final, known, j, learn) for learn in (True, False)]
        torque, noise = (np.concatenate(column) for column in zip(*sets, strict=True))
        rms = float(np.sqrt(np.mean(np.concatenate([motion.u[:, j] for motion in regression.motions]) ** 2)))
        # Beyond the errors of noise and model, and what no model has in it.
        beyond = torque > ABOVE * coulomb + SIGMAS * noise + NEGLIGIBLE * rms
        if np.count_nonzero(beyond) <= 1:  # one may be a hand
            continue
        largest = float(torque.max())
        error = float(np.hypot(ABOVE * _MORE / EQUAL_SIGMAS * largest, noise[int(np.argmax(torque))]))
        learnt = float(sets[0][0].max(initial=coulomb))
        was, left = (float(np.sum(np.maximum(sets[1][0] - level, 0.0) ** 2)) for level in (coulomb, learnt))
        gain = 1.0 - left / was if was > 0.0 else 0.0
        found.append(Holding(j, FittedParameter(ABOVE * largest, error, unit, True), gain))
    return found


def sticking(arm: Arm, held: Sequence[Holding]) -> Arm:
    """Return an arm whose joints stick, too."""
    effects = tuple(Effect(EFFECT, {"static_N_m": one.parameter.value}, joints=(one.joint + 1,)) for one in held)
    return replace(arm, effects=(*arm.effects, *effects)) if effects else arm


def _held(
    regression: Regression, final: Candidate, known: Floats, joint: int, learn: bool
) -> tuple[Floats, Floats]:
    """Return what has held a joint in each rest, and its standard error, (n_rest,) each."""
    torque, noise = [], []
    for motion in regression.motions:
        if motion.learn != learn:
            continue
        rests = inner_rests(motion.stuck[:, joint], motion.dt_s)
        if not rests:
            continue
        held = regression.equations.left(final.model, final.x, motion)[:, joint]
        slopes = regression.equations.slopes(final.model, final.x, motion)[:, joint]
        for part in rests:
            weight = np.hanning(part.stop - part.start + 2)[1:-1]
            weight /= weight.sum()
            torque.append(abs(float(weight @ held[part])))
            slope = weight @ slopes[part]
            model_error = np.sqrt(max(float(slope @ known @ slope), 0.0))
            noise.append(float(np.hypot(regression.weighting.mean_noise(joint, weight, motion.dt_s), model_error)))
    return np.array(torque), np.array(noise)
