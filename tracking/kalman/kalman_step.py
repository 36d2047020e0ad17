"""One step of the Kalman filter over readings: compiled, shared by the offline filter and the smoother.

A joint's acceleration wanders as if pushed at random; within a step it changes evenly, so that its mean over a
step is what the readings' mean over that step shows. Readings are taken in one after the other, which needs no
matrix to be inverted: their noise is independent.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.model.course import Course
from tracking.model.expected_readings import Room, observe
from tracking.model.observation import Observation
from tracking.model.stationary_process import decay, transition


@compiled
def spread(P: Floats, j: int, variance: float, dt: float) -> None:
    """Add what an even change of joint j's acceleration within the step does: to q, dq and ddq together."""
    gain = (dt * dt / 6.0, dt / 2.0, 1.0)
    for a in range(3):
        for b in range(3):
            P[3 * j + a, 3 * j + b] += variance * gain[a] * gain[b]


@compiled
def predict(of: Observation, course: Course, k: int, x: Floats, P: Floats) -> None:
    """Carry state and covariance from instant k - 1 to k."""
    dt, n, size = course.dt, course.push.size, x.size
    for j in range(n):
        q = 3 * j
        qv, qa, vv, va, av, aa = transition(course.rate[j], dt)
        v, a = x[q + 1], x[q + 2]
        x[q] += qv * v + qa * a
        x[q + 1], x[q + 2] = vv * v + va * a, av * v + aa * a
        for c in range(size):
            v, a = P[q + 1, c], P[q + 2, c]
            P[q, c] += qv * v + qa * a
            P[q + 1, c], P[q + 2, c] = vv * v + va * a, av * v + aa * a
        for c in range(size):
            v, a = P[c, q + 1], P[c, q + 2]
            P[c, q] += qv * v + qa * a
            P[c, q + 1], P[c, q + 2] = vv * v + va * a, av * v + aa * a
        spread(P, j, course.push[j] * dt + course.jolt[k, j], dt)
    for channel in range(course.noise.size):
        o = 3 * n + channel
        P[o, o] += course.wander[channel] * dt
        if of.settled_column[channel // 3] >= 0:
            forget(of, course, k, channel, x, P)
    kept = np.exp(-dt / course.memory_s) if of.base_column >= 0 or of.lack_column >= 0 else 0.0
    if of.base_column >= 0:
        for axis in range(3):
            decay(x, P, of.base_column + axis, kept, course.base_std)
    if of.lack_column >= 0:
        for channel in range(course.noise.size):
            decay(x, P, of.lack_column + channel, kept, course.lack_std[channel])
    for a in range(size):  # rounding must not add up to a covariance that is not symmetric
        for b in range(a):
            P[b, a] = P[a, b]


@compiled
def forgetting(of: Observation, course: Course, k: int, channel: int, x: Floats) -> tuple[float, float]:
    """Return what an AC-coupled channel forgets in the step up to k: its rate, and by how much it stands off.

    ``offset' = -corner (reading - settled)``: what remains of an old level decays with the reading itself.
    """
    s, axis = channel // 3, channel % 3
    corner = of.corner[s]
    if of.corner_column[s] >= 0:
        corner += x[of.corner_column[s]]
    stands = 0.0
    if course.present[k - 1] and course.present[k]:
        stands = 0.5 * (course.readings[k - 1, channel] + course.readings[k, channel])
        stands -= x[of.settled_column[s] + axis]
    return corner, stands


@compiled
def forget(of: Observation, course: Course, k: int, channel: int, x: Floats, P: Floats) -> None:
    """Carry the offset of an AC-coupled channel from instant k - 1 to k."""
    dt, s, size = course.dt, channel // 3, x.size
    o, settled, at = 3 * course.push.size + channel, of.settled_column[s] + channel % 3, of.corner_column[s]
    corner, stands = forgetting(of, course, k, channel, x)
    x[o] -= dt * corner * stands
    for c in range(size):
        P[o, c] += dt * corner * P[settled, c]
        if at >= 0:
            P[o, c] -= dt * stands * P[at, c]
    for c in range(size):
        P[c, o] += dt * corner * P[c, settled]
        if at >= 0:
            P[c, o] -= dt * stands * P[c, at]
    lost = 0.0 if course.present[k - 1] and course.present[k] else 1.0  # a reading of 1 m/s^2 may have been missed
    P[o, o] += (dt * corner) ** 2 * (course.noise[channel] + lost)


@compiled
def take(
    x: Floats,
    P: Floats,
    slope: Floats,
    columns: NDArray[np.int64],
    n_column: int,
    miss: float,
    variance: float,
    gain: Floats,
) -> float:
    """Take in one reading that misses its prediction by ``miss``; return the variance of that.

    The gain is left in ``gain``. Only the entries ``columns[:n_column]`` of ``slope`` count. All runs along the
    rows of P, which stays symmetric to the last digit.
    """
    size = x.size
    for a in range(size):
        gain[a] = 0.0
    for c in range(n_column):
        column = columns[c]
        for a in range(size):
            gain[a] += P[column, a] * slope[column]
    total = variance
    for c in range(n_column):
        total += slope[columns[c]] * gain[columns[c]]
    share = 1.0 / total
    for a in range(size):
        for b in range(size):
            P[a, b] -= gain[a] * gain[b] * share
    for a in range(size):
        gain[a] /= total
        x[a] += gain[a] * miss
    return total


class Taken(NamedTuple):
    """What was taken in at one instant: for each reading, and for each joint at rest, in this order.

    ``slope`` (n_channel, n_state), ``gain`` (n_channel + n_joint, n_state), ``miss`` and ``total``
    (n_channel + n_joint,): what was missed by, and the variance of that.
    """

    slope: Floats
    gain: Floats
    miss: Floats
    total: Floats


@compiled
def correct(
    of: Observation, room: Room, course: Course, k: int, at: Floats, x: Floats, P: Floats, taken: Taken
) -> float:
    """Take in the readings of instant k, linearised in the state ``at``; return the misses' squared size.

    That is the sum of ``miss^2 / total``, about as large as there are channels where the model is right. The
    readings are taken in one after the other, as `take` does, but what they take from P is subtracted at the end,
    in one sweep of that matrix.
    """
    n_channel, size = course.noise.size, x.size
    squared = 0.0
    observe(of, room, at, taken.miss[:n_channel], taken.slope)
    for channel in range(n_channel):
        clock = of.clock_column[channel // 3]
        if clock >= 0:
            taken.slope[channel, clock] = -course.drift[k, channel]
            taken.miss[channel] -= course.drift[k, channel] * at[clock]
        columns, n_column, slope = of.columns[channel], of.n_column[channel], taken.slope[channel]
        miss = course.readings[k, channel] - taken.miss[channel]
        for c in range(n_column):
            miss -= slope[columns[c]] * (x[columns[c]] - at[columns[c]])
        gain = taken.gain[channel]
        project(P, slope, columns, n_column, taken, channel, gain)
        total = course.noise[channel] * course.doubt[k, channel]
        for c in range(n_column):
            total += slope[columns[c]] * gain[columns[c]]
        for a in range(size):
            gain[a] /= total
            x[a] += gain[a] * miss
        taken.miss[channel], taken.total[channel] = miss, total
        squared += miss * miss / total
    subtract(P, taken, n_channel)
    return squared


@compiled
def project(
    P: Floats,
    slope: Floats,
    columns: NDArray[np.int64],
    n_column: int,
    taken: Taken,
    n_taken: int,
    projected: Floats,
) -> None:
    """Fill in the covariance of the state with a reading: P, less what the first ones take from it, by slope."""
    size = projected.size
    projected[:] = 0.0
    for c in range(n_column):
        column = columns[c]
        for a in range(size):
            projected[a] += P[column, a] * slope[column]
    for before in range(n_taken):
        share = 0.0
        for c in range(n_column):
            share += slope[columns[c]] * taken.gain[before, columns[c]]
        share *= taken.total[before]
        for a in range(size):
            projected[a] -= share * taken.gain[before, a]


@compiled
def subtract(P: Floats, taken: Taken, n_taken: int) -> None:
    """Subtract from P what the first readings take from it, ``gain gain^T total`` each; a sensor's axes at once.

    P stays symmetric to the last digit.
    """
    size = P.shape[0]
    root = np.empty((n_taken, size))
    for row in range(n_taken):
        scale = np.sqrt(taken.total[row])
        for a in range(size):
            root[row, a] = scale * taken.gain[row, a]
    for a in range(size):
        for row in range(0, n_taken, 3):
            x, y, z = root[row, a], root[row + 1, a], root[row + 2, a]
            for b in range(a + 1):
                P[a, b] -= x * root[row, b] + y * root[row + 1, b] + z * root[row + 2, b]
    for a in range(size):
        for b in range(a):
            P[b, a] = P[a, b]


@compiled
def hold(course: Course, k: int, x: Floats, P: Floats, taken: Taken) -> None:
    """Take in that joints rest at instant k, those of which it is known."""
    n_channel = course.noise.size
    one, column = np.ones(x.size), np.zeros(1, dtype=np.int64)
    for j in range(course.push.size):
        row = n_channel + j
        if course.rest[k, j] > 0.0:
            column[0] = 3 * j + 1
            taken.miss[row] = -x[3 * j + 1]
            taken.total[row] = take(x, P, one, column, 1, -x[3 * j + 1], course.rest[k, j], taken.gain[row])
        else:
            taken.total[row] = np.inf


@compiled
def room_to_take(course: Course, size: int, stretch: int) -> list[Taken]:
    """Return room for what is taken in within a stretch."""
    n_channel, n_joint = course.noise.size, course.push.size
    slope = np.zeros((stretch, n_channel, size))
    gain = np.zeros((stretch, n_channel + n_joint, size))
    miss, total = np.zeros((stretch, n_channel + n_joint)), np.zeros((stretch, n_channel + n_joint))
    return [Taken(slope[i], gain[i], miss[i], total[i]) for i in range(stretch)]


@compiled
def filter_step(
    of: Observation, room: Room, course: Course, k: int, at: Floats, x: Floats, P: Floats, taken: Taken
) -> float:
    """Carry the filter to instant k and take in what was read there; return the misses' squared size."""
    if k > 0:
        predict(of, course, k, x, P)
    taken.total[:] = np.inf
    squared = 0.0
    if course.present[k]:
        squared = correct(of, room, course, k, at[k], x, P, taken)
    hold(course, k, x, P, taken)
    return squared
