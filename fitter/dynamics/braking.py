r"""Friction brakes: what resists at a joint adds up to a torque against its motion, at every speed that was seen.

Friction is the part of a torque that turns round with the direction of motion. With ``f_e(v)`` what an effect
resists with at speed ``v``, others' springs, offsets and ripples drop out of

.. math:: F_j(v) = D_j v + f_{c,j} + \sum_e (f_e(v) - f_e(-v)) / 2 \ge 0

Each term may be negative, the sum may not.
"""

from collections.abc import Sequence

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import number
from arm.effects.joint_torque import COULOMB, DIRECTION, DQ, N_STATE, VISCOUS, Q, T, torque_along
from arm.model import Arm, Floats
from fitter.data.trial import Trial

#: Speeds at which it is asked, of each joint: the slowest and the fastest that were seen, and quantiles between.
_SPEEDS = 12


def seen_states(trials: Sequence[Trial]) -> Floats:
    """Return time, angle and speed of samples that stand for all speeds a joint was seen at.

    Parameters
    ----------
    trials : sequence of Trial

    Returns
    -------
    (3, n_speed, n_joint)
        Zero speed for a joint that never moved.
    """
    t = np.concatenate([trial.began_s + trial.t for trial in trials])
    q, dq = (np.concatenate([getattr(trial, name) for trial in trials]) for name in ("q", "dq"))
    states = np.zeros((3, _SPEEDS, q.shape[1]))
    for j in range(q.shape[1]):
        moving = np.flatnonzero(dq[:, j])
        if len(moving):
            order = moving[np.argsort(np.abs(dq[moving, j]))]
            at = order[np.linspace(0, len(order) - 1, _SPEEDS).round().astype(int)]
            states[:, :, j] = t[at], q[at, j], np.abs(dq[at, j])
    return states


def friction_at(arm: Arm, friction: Floats, states: Floats) -> tuple[Floats, Floats]:
    """Return what friction adds up to, and the largest of its terms.

    Parameters
    ----------
    arm : Arm
        Its effects.
    friction : (n_joint, 3)
        Viscous, Coulomb and static.
    states : (3, n_speed, n_joint)

    Returns
    -------
    total : (n_speed, n_joint) [N m or N]
    largest : (n_joint,)
    """
    t, q, speed = states
    terms = [speed * friction[:, 0], np.tile(friction[:, 1], (len(speed), 1))]
    for effect in arm.effects:
        kind = catalogue()[effect.name]
        if kind.torque is None:
            continue
        row = np.array([number(effect.parameters, parameter.name) for parameter in kind.numbers])
        for j in (joint - 1 for joint in effect.joints):
            both = []
            for way in (1.0, -1.0):
                x = np.zeros((len(speed), N_STATE))  # without a load: it may be gone at any speed
                x[:, T], x[:, Q], x[:, DQ], x[:, DIRECTION] = t[:, j], q[:, j], way * speed[:, j], way
                x[:, VISCOUS], x[:, COULOMB] = friction[j, 0], friction[j, 1]
                both.append(torque_along(kind, row, x))
            term = np.zeros_like(speed)
            term[:, j] = (both[0] - both[1]) / 2.0
            terms.append(term)
    return np.sum(terms, axis=0), np.abs(terms).max(axis=(0, 1))
