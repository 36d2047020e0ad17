"""Whole turns that nobody saw: after a gap gravity shows an angle, but not how often the joint went round."""

import numpy as np

from arm.model import Arm, Floats
from tracking.kalman.dropout import TOLD_S, most_probable_way
from tracking.model.course import Course

#: A whole turn [rad].
_TURN = 2.0 * np.pi
#: Over how long the speeds and accelerations at the ends of a gap are averaged [s].
_END_S = 0.02


def unwound(states: Floats, course: Course, arm: Arm, long_too: bool = False) -> Floats | None:
    """Return the motion without whole turns that what is known of a gap speaks against; None if it has none.

    The speeds and accelerations at the two ends tell how far a joint most probably came between them.

    Parameters
    ----------
    states : (n, n_state)
        Smoothed or filtered.
    course : Course
        What was read at those instants.
    arm : Arm
    long_too : bool
        Look at gaps of more than `TOLD_S` too, after which a joint is held to be about where it was.
    """
    present = np.flatnonzero(course.present)
    turning = np.array([3 * j for j, joint in enumerate(arm.joints) if joint.type == "revolute"], dtype=int)
    few = max(1, round(_END_S / course.dt))
    left = states.copy()
    for gap in np.flatnonzero(np.diff(present) > 1):
        before, after = present[gap], present[gap + 1]
        T = (after - before) * course.dt
        if T > TOLD_S and not long_too:
            continue
        begin = states[max(0, before - few + 1) : before + 1].mean(axis=0)
        end = states[after : after + few].mean(axis=0)
        expected = most_probable_way(T, begin[turning + 1], begin[turning + 2], end[turning + 1], end[turning + 2])
        if T > TOLD_S:
            expected[:] = 0.0
        turns = np.round((states[after, turning] - states[before, turning] - expected) / _TURN)
        share = np.arange(1, after - before)[:, None] / (after - before)
        left[after:, turning] -= turns * _TURN
        left[before + 1 : after, turning] -= turns * _TURN * share
        left[before + 1 : after, turning + 1] -= turns * _TURN / T
    return None if np.array_equal(left, states) else left
