"""Whole turns that nobody saw: after a gap gravity shows an angle, but not how often the joint went round."""

import numpy as np

from arm.model import Arm, Floats
from tracking.kalman_step import Course

_TURN = 2.0 * np.pi
#: Over how long the speeds at the ends of a gap are averaged [s].
_END_S = 0.02


def unwound(states: Floats, course: Course, arm: Arm) -> Floats | None:
    """Return the motion without whole turns that the speeds about a gap speak against; None if it has none.

    With speeds ``v0`` and ``v1`` at its ends a joint has most probably come as far as ``T (v0 + v1) / 2`` in a gap
    of length T; what its accelerations add to that (`tracking.loss.Loss.regain`) is no whole turn.

    Parameters
    ----------
    states : (n, n_state)
        Smoothed.
    course : Course
        What was read at those instants.
    arm : Arm
    """
    present = np.flatnonzero(course.present)
    left = states.copy()
    few = max(1, round(_END_S / course.dt))
    for before, after in zip(present[:-1], present[1:], strict=True):
        if after == before + 1:
            continue
        T = (after - before) * course.dt
        for j, joint in enumerate(arm.joints):
            if joint.type != "revolute":
                continue
            v0 = states[max(0, before - few + 1) : before + 1, 3 * j + 1].mean()
            v1 = states[after : after + few, 3 * j + 1].mean()
            turns = np.round((states[after, 3 * j] - states[before, 3 * j] - 0.5 * T * (v0 + v1)) / _TURN)
            left[after:, 3 * j] -= turns * _TURN
            share = np.arange(1, after - before) / (after - before)
            left[before + 1 : after, 3 * j] -= turns * _TURN * share
            left[before + 1 : after, 3 * j + 1] -= turns * _TURN / T
    return left if (left[-1] != states[-1]).any() else None
