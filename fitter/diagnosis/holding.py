"""Static friction: a joint at rest is held by more than ever resists it while it moves.

The equations of a stuck joint tell nothing of the arm, and are eliminated from every fit (`equation`). They do
tell what holds the joint: the drive's torque less the arm's own. Coulomb friction holds up to its own level;
whatever holds more is the paper's F.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.effects.catalogue import catalogue
from arm.model import Floats
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate
from fitter.search.fitted_parameter import FittedParameter

#: A rest counts where it lasts this long once this much is cut off at both its ends [s].
_LASTS_S, _CUT_S = 0.1, 0.06
#: A rest is held by more than Coulomb friction if it is so by this share of it and by so many times its noise.
_MORE, _SIGMAS = 0.25, 6.0
#: Effects that hold a joint by more than Coulomb friction themselves.
_HOLDS = ("stribeck", "load_friction", "coulomb_asymmetry")
#: So many rests must be, for one may be a hand.
_LEAST = 3


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


def holdings(regression: Regression, final: Candidate) -> list[Holding]:
    """Return the joints that stick, and at what torque.

    Its error says how far apart the largest torques are: the true F is not below the largest, and hardly above by
    more than what is between it and the next.
    """
    unit = catalogue()["stiction"].parameters[0].unit
    found = []
    friction = regression.friction_of(final.model, final.x)[:, 1]
    for j in range(regression.arm.n_joint):
        if any(one.kind.name in _HOLDS and j in one.joints for one in final.model.hypotheses):
            continue
        coulomb = abs(float(friction[j]))
        sets = [_held(regression, final, j, learn) for learn in (True, False)]
        torque, noise = (np.concatenate(column) for column in zip(*sets, strict=True))
        beyond = torque > (1.0 + _MORE) * coulomb + _SIGMAS * noise
        if np.count_nonzero(beyond) < _LEAST:
            continue
        order = np.sort(torque[beyond])[::-1]
        F, error = float(order[0]), float(order[0] - order[1] + noise[beyond].max() + order[0] / len(order))
        learnt = float(sets[0][0].max(initial=coulomb))
        was, left = (float(np.sum(np.maximum(sets[1][0] - level, 0.0) ** 2)) for level in (coulomb, learnt))
        gain = 1.0 - left / was if was > 0.0 else 0.0
        found.append(Holding(j, FittedParameter(F, error / 2.0, unit, True), gain))
    return found


def _held(regression: Regression, final: Candidate, joint: int, learn: bool) -> tuple[Floats, Floats]:
    """Return what has held a joint in each rest, and its noise, (n_rest,) each."""
    torque, noise = [], []
    for motion in regression.motions:
        if motion.learn != learn:
            continue
        view = regression.view(final.model, motion)
        rows = np.concatenate([view.base(regression.independent(view.arm)), *view.columns], axis=2)
        held = (view.target(regression.known) - rows @ final.x)[:, joint]
        for part in _rests(motion, joint):
            torque.append(abs(float(held[part].mean())))
            noise.append(float(held[part].std() / np.sqrt(max(1.0, (part.stop - part.start) / 4.0))))
    return np.array(torque), np.array(noise)


def _rests(motion: Motion, joint: int) -> Sequence[slice]:
    stuck = motion.stuck[:, joint].astype(np.int8)
    edges = np.diff(np.concatenate([[0], stuck, [0]]))
    cut = round(_CUT_S / motion.dt_s)
    return [
        slice(begin + cut, end - cut)
        for begin, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
        if (end - begin - 2 * cut) * motion.dt_s >= _LASTS_S
    ]
