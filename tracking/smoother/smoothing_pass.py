"""Fixed-interval smoothing, one pass: forwards with the filter, backwards with its adjoint (Bryson and Frazier).

The backward pass carries a vector and a matrix that say by how much later readings move an earlier estimate and
shrink its covariance; no covariance is inverted, so constants, exactly known entries and readings taken in one by
one are no trouble. (A. E. Bryson, M. Frazier, 1963; G. J. Bierman, *Fixed interval smoothing with discrete
measurements*, 1973.) Of a short course all that the filter did is kept. Of a long one only its last stretch is.
The others are filtered again from marks left on the way, so memory stays bounded by the length of a stretch and
the number of marks.
"""

from typing import NamedTuple

import numpy as np

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.kalman.kalman_step import filter_step, room_to_take
from tracking.model.course import Course
from tracking.model.expected_readings import Room
from tracking.model.observation import Observation
from tracking.smoother.adjoint import carry_back, give_back, reported_variance

#: Instants between two marks of a course of which not all is kept.
STRETCH = 128
#: Memory for the filter's results of a course [bytes]: a few thousand instants, and little on any machine.
_KEPT_BYTES = 64 * 1024 * 1024


class Pass(NamedTuple):
    """What a pass finds.

    Attributes
    ----------
    states : (n, n_state)
    variance : (n, n_reported)
        Of the entries that `Observation.reported` names.
    error, precision : (n, n_channel + n_joint)
        Smoothing errors u of the readings, and of the joints at rest, and their variances D: the noise of a
        reading whose variance is R is most probably R u, with the variance R - R^2 D (P. de Jong 1989). Mean
        u^2 / D is 1 where the model is right.
    """

    states: Floats
    variance: Floats
    error: Floats
    precision: Floats


@compiled
def pass_of(of: Observation, course: Course, size: int) -> Pass:
    """Return room for what a pass over a course finds."""
    n, rows = course.readings.shape[0], course.noise.size + course.push.size
    return Pass(np.empty((n, size)), np.zeros((n, of.reported.size)), np.zeros((n, rows)), np.zeros((n, rows)))


@compiled
def smooth_once(
    of: Observation, room: Room, course: Course, at: Floats, x: Floats, P: Floats, found: Pass, with_variance: bool
) -> float:
    """Fill in what is found, all readings being linearised along ``at`` (n, n_state).

    Parameters
    ----------
    x, P : (n_state,), (n_state, n_state)
        Before the first reading; after the call, after the last one.
    found : Pass
        Variances and precisions only where ``with_variance``.

    Returns
    -------
    float
        The misses' squared size, minus twice the logarithm of the readings' likelihood up to a constant.
    """
    return smooth_in_stretches(of, room, course, at, x, P, found, with_variance, stretch_of(course, x.size))


@compiled
def smooth_in_stretches(
    of: Observation,
    room: Room,
    course: Course,
    at: Floats,
    x: Floats,
    P: Floats,
    found: Pass,
    with_variance: bool,
    stretch: int,
) -> float:
    """Do what `smooth_once` does, with checkpoints ``stretch`` instants apart."""
    of, room, course = borrowed(of), borrowed(room), borrowed(course)  # the caller keeps them
    n, size = course.readings.shape[0], x.size
    marks = (n + stretch - 1) // stretch
    mark_x, mark_P = np.empty((marks, size)), np.empty((marks, size, size))
    after_x, after_P = np.empty((stretch, size)), np.empty((stretch, size, size))
    taken = room_to_take(course, size, stretch)
    cost = 0.0
    for m in range(marks):
        mark_x[m], mark_P[m] = x, P
        for k in range(m * stretch, min(n, (m + 1) * stretch)):
            i = k - m * stretch
            one = borrowed(taken[i])
            cost += filter_step(of, room, course, k, at, x, P, one)
            after_x[i], after_P[i] = x, P
            total = one.total
            for row in range(total.size):
                if np.isfinite(total[row]):
                    cost += np.log(total[row])
    last_x, last_P = x.copy(), P.copy()
    later, shrink = np.zeros(size), np.zeros((size, size))
    for m in range(marks - 1, -1, -1):
        first, last = m * stretch, min(n, (m + 1) * stretch)
        if m < marks - 1:  # what was kept is of the last stretch
            x[:], P[:] = mark_x[m], mark_P[m]
            for k in range(first, last):
                filter_step(of, room, course, k, at, x, P, taken[k - first])
                after_x[k - first], after_P[k - first] = x, P
        for k in range(last - 1, first - 1, -1):
            i = k - first
            found.states[k] = after_x[i]
            for b in range(size):  # along the rows of a symmetric matrix
                for a in range(size):
                    found.states[k, a] -= after_P[i, b, a] * later[b]
            if with_variance:
                reported_variance(of.reported, after_P[i], shrink, found.variance[k])
            one = borrowed(taken[i])
            give_back(of, course, one, later, shrink, with_variance, found.error[k], found.precision[k])
            if k > 0:
                carry_back(of, course, k, at[k], later, shrink, with_variance)
    x[:], P[:] = last_x, last_P
    return cost


@compiled
def stretch_of(course: Course, size: int) -> int:
    """Return how many instants lie between two marks: all of a course that is short enough."""
    n, n_channel, n_joint = course.readings.shape[0], course.noise.size, course.push.size
    rows = n_channel + n_joint
    number_bytes = 8
    of_instant = number_bytes * (size + size * size + n_channel * size + rows * size + 2 * rows)
    return max(n, 1) if n * of_instant <= _KEPT_BYTES else STRETCH
