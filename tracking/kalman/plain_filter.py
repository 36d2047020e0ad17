"""The extended Kalman filter over a whole recording and nothing else: no rests, no jolts, no doubts. Compiled."""

import numpy as np

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.kalman.kalman_step import correct, hold, predict, room_to_take
from tracking.model.course import Course
from tracking.model.expected_readings import Room, room_of
from tracking.model.observation import Observation


def filter_plainly(of: Observation, course: Course, x: Floats, P: Floats) -> Floats:
    """Return the filtered states, (n, n_state), readings being linearised where each is predicted.

    Parameters
    ----------
    x, P : (n_state,), (n_state, n_state)
        Before the first reading; they stay as they are.
    """
    states = np.empty((len(course.readings), x.size))
    _filter_along(of, room_of(course.push.size), course, x.copy(), P.copy(), states)
    return states


@compiled
def _filter_along(of: Observation, room: Room, course: Course, x: Floats, P: Floats, states: Floats) -> None:
    of, room, course = borrowed(of), borrowed(room), borrowed(course)  # the caller keeps them
    taken, at = room_to_take(course, x.size, 1)[0], np.empty(x.size)
    for k in range(states.shape[0]):
        if k > 0:
            predict(of, course, k, x, P)
        if course.present[k]:
            at[:] = x
            correct(of, room, course, k, at, x, P, taken)
        hold(course, k, x, P, taken)
        states[k] = x
