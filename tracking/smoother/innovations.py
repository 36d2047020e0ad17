"""Innovations of the filter: by how much each reading misses what those before it predict.

Where the model is right they are independent, whatever the motion, so that what stretches of a recording say of a
constant can be compared (F. C. Schweppe, *Evaluation of likelihood functions for Gaussian signals*, 1965).
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.kalman.kalman_step import filter_step, room_to_take
from tracking.model.course import Course
from tracking.model.expected_readings import Room
from tracking.model.observation import Observation


@compiled
def fill_innovations(
    of: Observation, room: Room, course: Course, at: Floats, x: Floats, P: Floats, miss: Floats, total: Floats
) -> None:
    """Fill in innovations and their variances, (n, n_channel + n_joint) each.

    Parameters
    ----------
    at : (n, n_state)
        Along which the readings are linearised.
    x, P : (n_state,), (n_state, n_state)
        Before the first reading; after the call, after the last one.
    miss, total
        0 and infinity where nothing was read, and of joints that do not rest.
    """
    of, room, course = borrowed(of), borrowed(room), borrowed(course)  # the caller keeps them
    one = room_to_take(course, x.size, 1)[0]  # not borrowed: nobody else keeps it
    for k in range(course.readings.shape[0]):
        filter_step(of, room, course, k, at, x, P, one)
        for row in range(one.total.size):
            total[k, row] = one.total[row]
            miss[k, row] = one.miss[row] if np.isfinite(one.total[row]) else 0.0
