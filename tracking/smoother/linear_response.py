"""How a smoothed motion answers to errors of its readings and of what was known before: many of them at once.

The smoother's gains depend on where the readings are linearised, not on the readings. What it makes of an error is
therefore one and the same linear map of every error, and draws of the errors, carried through that map side by
side, have the joint distribution of the motion's errors: of all instants, and with what the next motion inherits.
So have the constants of a recording that are moved one by one. The passes are those of
`tracking.smoother.smoothing_pass`, with a matrix of draws where that has one vector.
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.kalman.kalman_step import Taken, correct, forgetting, hold, predict, room_to_take
from tracking.model.course import Course
from tracking.model.expected_readings import Room
from tracking.model.observation import Observation
from tracking.model.stationary_process import transition
from tracking.smoother.smoothing_pass import STRETCH


@compiled
def respond(
    of: Observation,
    room: Room,
    course: Course,
    at: Floats,
    P: Floats,
    errors: Floats,
    noise: Floats,
    smoothed: Floats,
) -> None:
    """Fill in the errors of the smoothed states, (n, n_kept, n_draw), the first entries of each state.

    Parameters
    ----------
    at : (n, n_state)
        Along which the readings are linearised.
    P : (n_state, n_state)
        Covariance before the first reading; after the call, after the last one.
    errors : (n_state, n_draw)
        Of what was known before the first reading; after the call, of what is known after the last one.
    noise : (n, n_channel + n_joint, n_draw) [m/s^2], [rad/s or m/s]
        Errors of the readings, and the velocities that joints have where they are held to be at rest.
    """
    of, room, course = borrowed(of), borrowed(room), borrowed(course)  # the caller keeps them
    n, size, draws = course.readings.shape[0], P.shape[0], errors.shape[1]
    marks, rows = (n + STRETCH - 1) // STRETCH, course.noise.size + course.push.size
    mark_x, mark_P = np.empty((marks, size, draws)), np.empty((marks, size, size))
    taken, miss, x = room_to_take(course, size, STRETCH), np.zeros((STRETCH, rows, draws)), np.zeros(size)
    for m in range(marks):
        mark_x[m], mark_P[m] = errors, P
        for k in range(m * STRETCH, min(n, (m + 1) * STRETCH)):
            _forward(of, room, course, k, at, x, P, errors, noise, taken[0], miss[0])
    last_x, last_P = errors.copy(), P.copy()
    after_x, after_P = np.empty((STRETCH, size, draws)), np.empty((STRETCH, size, size))
    later = np.zeros((size, draws))
    for m in range(marks - 1, -1, -1):
        errors[:], P[:] = mark_x[m], mark_P[m]
        first, last = m * STRETCH, min(n, (m + 1) * STRETCH)
        for k in range(first, last):
            i = k - first
            _forward(of, room, course, k, at, x, P, errors, noise, taken[i], miss[i])
            after_x[i], after_P[i] = errors, P
        for k in range(last - 1, first - 1, -1):
            i = k - first
            for a in range(smoothed.shape[1]):
                smoothed[k, a] = after_x[i, a]
                for b in range(size):
                    weight = after_P[i, a, b]
                    for d in range(draws):
                        smoothed[k, a, d] -= weight * later[b, d]
            _give_back(of, course, taken[i], miss[i], later)
            if k > 0:
                _carry_back(of, course, k, at[k], later)
    errors[:], P[:] = last_x, last_P


@compiled
def fill_misses(
    of: Observation, room: Room, course: Course, at: Floats, P: Floats, errors: Floats, noise: Floats, miss: Floats
) -> None:
    """Fill in by how much more the filter's readings miss for the errors, (n, n_channel + n_joint, n_draw).

    Of what was not read, and of joints that do not rest, it is 0. The other parameters are those of `respond`.
    """
    of, room, course = borrowed(of), borrowed(room), borrowed(course)  # the caller keeps them
    taken, x = room_to_take(course, P.shape[0], 1)[0], np.zeros(P.shape[0])  # not borrowed: nobody else keeps it
    for k in range(course.readings.shape[0]):
        miss[k] = 0.0
        _forward(of, room, course, k, at, x, P, errors, noise, taken, miss[k])


@compiled
def _forward(
    of: Observation,
    room: Room,
    course: Course,
    k: int,
    at: Floats,
    x: Floats,
    P: Floats,
    errors: Floats,
    noise: Floats,
    taken: Taken,
    miss: Floats,
) -> None:
    """Carry the errors to instant k and take in the readings' own."""
    n, n_channel, draws = course.push.size, course.noise.size, errors.shape[1]
    x[:] = at[k]  # a place to work in: gains are the same for any state
    if k > 0:
        predict(of, course, k, x, P)
        _predict_errors(of, course, k, at[k - 1], errors, noise)
    taken.total[:] = np.inf
    x[:] = at[k]
    if course.present[k]:
        correct(of, room, course, k, at[k], x, P, taken)
        for channel in range(n_channel):
            _take_errors(
                errors,
                taken.slope[channel],
                of.columns[channel],
                of.n_column[channel],
                taken.gain[channel],
                noise[k, channel],
                miss[channel],
            )
    hold(course, k, x, P, taken)
    for j in range(n):
        row = n_channel + j
        if np.isfinite(taken.total[row]):
            for d in range(draws):
                miss[row, d] = noise[k, row, d] - errors[3 * j + 1, d]
            for a in range(errors.shape[0]):
                for d in range(draws):
                    errors[a, d] += taken.gain[row, a] * miss[row, d]


@compiled
def _take_errors(
    errors: Floats, slope: Floats, columns: np.ndarray, n_column: int, gain: Floats, noise: Floats, miss: Floats
) -> None:
    """Take in the errors of one reading, (n_draw,)."""
    draws = errors.shape[1]
    for d in range(draws):
        miss[d] = noise[d]
    for c in range(n_column):
        weight = slope[columns[c]]
        for d in range(draws):
            miss[d] -= weight * errors[columns[c], d]
    for a in range(errors.shape[0]):
        weight = gain[a]
        for d in range(draws):
            errors[a, d] += weight * miss[d]


@compiled
def _predict_errors(of: Observation, course: Course, k: int, at: Floats, errors: Floats, noise: Floats) -> None:
    """Carry the errors from instant k - 1 to k, as `tracking.kalman.kalman_step.predict` carries a state."""
    dt, n = course.dt, course.push.size
    for j in range(n):
        q = 3 * j
        qv, qa, vv, va, av, aa = transition(course.rate[j], dt)
        for d in range(errors.shape[1]):
            v, a = errors[q + 1, d], errors[q + 2, d]
            errors[q, d] += qv * v + qa * a
            errors[q + 1, d], errors[q + 2, d] = vv * v + va * a, av * v + aa * a
    for channel in range(course.noise.size):
        s = channel // 3
        if of.settled_column[s] < 0:
            continue
        o, settled = 3 * n + channel, of.settled_column[s] + channel % 3
        corner, stands = forgetting(of, course, k, channel, at)
        seen = course.present[k - 1] and course.present[k]
        for d in range(errors.shape[1]):
            felt = 0.5 * (noise[k - 1, channel, d] + noise[k, channel, d]) - errors[settled, d] if seen else 0.0
            errors[o, d] -= dt * corner * felt
            if of.corner_column[s] >= 0:
                errors[o, d] -= dt * stands * errors[of.corner_column[s], d]
    _forget(of, course, errors)


@compiled
def _forget(of: Observation, course: Course, errors: Floats) -> None:
    """Let errors of what decays decay by a step; their adjoints do so alike."""
    kept = np.exp(-course.dt / course.memory_s)
    if of.base_column >= 0:
        for axis in range(3):
            errors[of.base_column + axis] *= kept
    if of.lack_column >= 0:
        for channel in range(course.noise.size):
            errors[of.lack_column + channel] *= kept


@compiled
def _give_back(of: Observation, course: Course, taken: Taken, miss: Floats, later: Floats) -> None:
    """Carry the adjoints from after the readings of an instant to before them, the last one first."""
    n_channel, size, draws = course.noise.size, later.shape[0], later.shape[1]
    pull = np.empty(draws)
    for row in range(taken.total.size - 1, -1, -1):
        total, gain = taken.total[row], taken.gain[row]
        if not np.isfinite(total):
            continue
        for d in range(draws):
            pull[d] = miss[row, d] / total
        for a in range(size):
            for d in range(draws):
                pull[d] += gain[a] * later[a, d]
        if row >= n_channel:
            for d in range(draws):
                later[3 * (row - n_channel) + 1, d] -= pull[d]
            continue
        for c in range(of.n_column[row]):
            column = of.columns[row, c]
            for d in range(draws):
                later[column, d] -= taken.slope[row, column] * pull[d]


@compiled
def _carry_back(of: Observation, course: Course, k: int, at: Floats, later: Floats) -> None:
    """Carry the adjoints from instant k to k - 1: the transpose of `_predict_errors`."""
    dt, n = course.dt, course.push.size
    _forget(of, course, later)
    for s in range(of.corner.size):
        if of.settled_column[s] < 0:
            continue
        for axis in range(3):
            channel = 3 * s + axis
            o, settled, corner_at = 3 * n + channel, of.settled_column[s] + axis, of.corner_column[s]
            corner, stands = forgetting(of, course, k, channel, at)
            later[settled] += dt * corner * later[o]
            if corner_at >= 0:
                later[corner_at] -= dt * stands * later[o]
    for j in range(n):
        q = 3 * j
        qv, qa, vv, va, av, aa = transition(course.rate[j], dt)
        for d in range(later.shape[1]):
            angle, v, a = later[q, d], later[q + 1, d], later[q + 2, d]
            later[q + 1, d], later[q + 2, d] = qv * angle + vv * v + av * a, qa * angle + va * v + aa * a
