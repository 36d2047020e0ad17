"""The Kalman filter over a whole recording: compiled. It finds rests, jolts and readings to be doubted.

It is what the smoother starts from; its own answer is that of `tracking.kalman.kalman_filter`, but for rounding.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.kalman.kalman_step import Taken, correct, hold, predict, spread
from tracking.model.course import Course
from tracking.model.expected_readings import Room, add_information, observe
from tracking.model.observation import Observation
from tracking.model.zero_velocity import TO_LEAVE, Window, at_rest, rest_variance, unrest


@compiled
def jolt_of(of: Observation, noise: Floats, slopes: Floats, miss: Floats, n: int) -> Floats:
    """Return the jump of the n accelerations that explains best by how much the readings were missed."""
    A, b = 1e-6 * np.eye(n), np.zeros(n)  # what no sensor feels does not jump
    add_information(of, noise, slopes, A)
    for channel in range(miss.size):
        for j in range(of.link[channel // 3] + 1):
            b[j] += slopes[channel, 3 * j + 2] * miss[channel] / noise[channel]
    return np.linalg.solve(A, b)  # type: ignore[return-value]


@compiled
def filter_all(
    of: Observation,
    room: Room,
    course: Course,
    window: Window,
    cell: int,
    limit: float,
    x: Floats,
    P: Floats,
    states: Floats,
    still: NDArray[np.bool_],
    resting: NDArray[np.bool_],
) -> None:
    """Fill in the filtered states (n, n_state), and of ``course`` the jolts, the doubts and the rests.

    Parameters
    ----------
    cell : int
        Instants of a cell of the window.
    limit : float
        Squared size of an instant's misses beyond which they are not noise.
    x, P
        Before the first reading; they are used up.
    still, resting : (n,)
        Filled in: where the velocities were held to be zero, and where no motion goes on.
    """
    of, room, course, window = borrowed(of), borrowed(room), borrowed(course), borrowed(window)  # the caller's
    n, size, n_channel, n_cell = course.push.size, x.size, course.noise.size, window.cells.shape[0]
    taken = Taken(
        np.zeros((n_channel, size)),
        np.zeros((n_channel + n, size)),
        np.zeros(n_channel + n),
        np.zeros(n_channel + n),
    )
    hidden, total = np.zeros(n), np.zeros(n_channel)
    before_x, before_P, at = x.copy(), P.copy(), x.copy()
    cells, in_cell, at_ease, no_motion = 0, 0, False, True
    if first_window(of, course, window, cell, x):
        at_ease = unrest(of, room, window, 0, x, P, hidden) < 1.0
    rest_at = at_rest(x, n)
    for k in range(course.readings.shape[0]):
        if k > 0:
            predict(of, course, k, x, P)
        if course.present[k]:
            before_x[:], before_P[:], at[:] = x, P, x
            if at_ease:  # where the rest began: what noise does to the slopes is no information
                at[:] = rest_at
            squared = correct(of, room, course, k, at, x, P, taken)
            if squared > limit:
                take_again(of, room, course, k, limit, at, before_x, before_P, x, P, taken)
            gather(of, course.readings[k], x, n, total)
            in_cell += 1
        else:
            cells, in_cell, at_ease = 0, 0, False  # what lies on both sides of a gap is no window
            total[:] = 0.0
        if at_ease:
            course.rest[k] = rest_variance(hidden, course.dt)
            hold(course, k, x, P, taken)
        states[k], still[k], resting[k] = x, at_ease, no_motion
        if in_cell == cell:
            window.cells[cells % n_cell] = total / cell
            total[:] = 0.0
            cells, in_cell = cells + 1, 0
            if cells >= n_cell:
                was_at_ease, share = at_ease, unrest(of, room, window, cells % n_cell, x, P, hidden)
                at_ease = share < 1.0
                no_motion = share < (TO_LEAVE if no_motion else 1.0)
                if at_ease and not was_at_ease:
                    rest_at = at_rest(x, n)


@compiled
def gather(of: Observation, reading: Floats, x: Floats, n: int, total: Floats) -> None:
    """Add a reading to a cell's total; an AC-coupled channel's offset never stays, so it is taken off."""
    for channel in range(reading.size):
        total[channel] += reading[channel]
        if of.settled_column[channel // 3] >= 0:
            total[channel] -= x[3 * n + channel]


@compiled
def first_window(of: Observation, course: Course, window: Window, cell: int, x: Floats) -> bool:
    """Fill the window with what is read first, before any of it is filtered; return whether it is all there."""
    n_cell = window.cells.shape[0]
    if course.readings.shape[0] < n_cell * cell or not course.present[: n_cell * cell].all():
        return False
    window.cells[:] = 0.0
    for k in range(n_cell * cell):
        gather(of, course.readings[k], x, course.push.size, window.cells[k // cell])
    window.cells[:] /= cell
    return True


@compiled
def take_again(
    of: Observation,
    room: Room,
    course: Course,
    k: int,
    limit: float,
    at: Floats,
    before_x: Floats,
    before_P: Floats,
    x: Floats,
    P: Floats,
    taken: Taken,
) -> None:
    """Take in instant k anew, allowing for a jolt, and then with as much doubt as is still needed."""
    n, n_channel = course.push.size, course.noise.size
    miss = np.empty(n_channel)
    at[:] = before_x
    observe(of, room, before_x, miss, taken.slope)
    miss[:] = course.readings[k] - miss
    jump = jolt_of(of, course.noise, taken.slope, miss, n)
    for j in range(n):
        course.jolt[k, j] += jump[j] ** 2
        spread(before_P, j, jump[j] ** 2, course.dt)
        at[3 * j + 2] += jump[j]  # where the readings are explained is where they are best linearised
    x[:], P[:] = before_x, before_P
    squared = correct(of, room, course, k, at, x, P, taken)
    if squared > limit:
        course.doubt[k] *= squared / n_channel
        x[:], P[:] = before_x, before_P
        correct(of, room, course, k, at, x, P, taken)
