"""Several frames of the live filter in one go, for as long as nothing happens: compiled.

A thousand frames a second leave no time to hand the arm to a kernel for each of their steps.
"""

import math

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.kalman.extended_kalman import correct, predict
from tracking.model.expected_readings import Room, observe, room_of
from tracking.model.observation import Observation
from tracking.model.zero_velocity import TO_LEAVE, Window, at_rest, rest_variance, unrest

Flags = NDArray[np.bool_]


@compiled
def stride(
    of: Observation,
    room: Room,
    F: Floats,
    Q: Floats,
    x: Floats,
    P: Floats,
    readings: Floats,
    rest_at: Floats,
    still: bool,
    noise: Floats,
    limit: float,
    slope: Floats,
    predicted: Floats,
    states: Floats,
    variances: Floats,
    sizes: Floats,
    total: Floats,
) -> tuple[int, Floats, Floats]:
    """Predict and take in readings (n, n_channel) until one is lost or explained badly.

    That one is not taken in. The steps are those of `tracking.kalman.live_filter.LiveFilter.step`.

    Parameters
    ----------
    of, room
        See `tracking.model.observation`.
    F, Q, x, P
        Of the filter.
    readings : (n, n_channel)
    rest_at : (n_state,)
        Where readings are linearised while the arm rests.
    still : bool
        Whether it does.
    noise : (n_row, n_row)
        Covariance of what is read: of the channels, and of the speeds while the arm rests.
    limit : float
        Of the innovation's squared size.
    slope, predicted : (n_row, n_state), (n_row,)
        Room, with the slopes of the speeds filled in.
    states, variances, sizes
        Filled in frame by frame: the state's beginning, the angles' variances and the innovation's squared size.
    total : (n_channel,)
        Readings that are taken in are added to it.

    Returns
    -------
    count : int
        How many were taken in.
    x, P
        The filter's state and its covariance after them.
    """
    n_joint, n_channel, n_row = variances.shape[1], readings.shape[1], noise.shape[0]
    values = np.zeros(n_row)  # a joint at rest reads a speed of zero
    if still:
        observe(of, room, rest_at, predicted[:n_channel], slope)
        for j in range(n_joint):
            predicted[n_channel + j] = rest_at[3 * j + 1]
    for k in range(readings.shape[0]):
        if math.isnan(readings[k, 0]):
            return k, x, P
        now, covariance = predict(F, Q, x, P)
        values[:n_channel] = readings[k]
        if still:
            now, covariance, squared = correct(now, covariance, values, slope, predicted, rest_at, noise)
        else:
            at = now.copy()
            observe(of, room, at, predicted, slope)
            now, covariance, squared = correct(now, covariance, values, slope, predicted, at, noise)
        if squared > limit or not math.isfinite(now.sum()):
            return k, x, P
        x, P = now, covariance
        states[k] = x[: states.shape[1]]
        for j in range(n_joint):
            variances[k, j] = P[3 * j, 3 * j]
        sizes[k] = squared
        total += readings[k]
    return readings.shape[0], x, P


@compiled
def strides(
    of: Observation,
    F: Floats,
    Q: Floats,
    x: Floats,
    P: Floats,
    readings: Floats,
    rest_at: Floats,
    still: bool,
    resting: bool,
    moving_noise: Floats,
    rest_noise: Floats,
    limits: tuple[float, float],
    window: Window,
    in_cell: int,
    n_cells: int,
    cell: int,
    dt: float,
    hidden: Floats,
    total: Floats,
    states: Floats,
    variances: Floats,
    sizes: Floats,
    shares: Floats,
    stills: Flags,
    restings: Flags,
) -> tuple[int, Floats, Floats, Floats, bool, bool, int, int]:
    """Do `stride` cell by cell, and judge at the end of each whether the arm rests.

    Passing these arrays to a kernel takes longer than a frame. A step that fails changes nothing.

    Parameters
    ----------
    of, F, Q, x, P, readings, rest_at, still, states, variances, sizes
        See `stride`.
    resting : bool
        Whether the arm is known to rest.
    moving_noise, rest_noise : (n_channel, n_channel), (n_channel + n_joint, n_channel + n_joint)
        Of what is read while it moves, and while it rests; the latter is learnt.
    limits : (moving, at rest)
        Of the innovation's squared size.
    window, hidden
        See `tracking.model.zero_velocity.unrest`.
    in_cell, n_cells, cell : int
        Frames of the cell so far, cells so far, frames that make a cell.
    dt : float
        From frame to frame [s].
    total : (n_channel,)
        Of the readings of the cell so far.
    shares : (n,)
        Filled in: the sizes, each by the number of what was read.
    stills, restings : (n,)
        Filled in: whether the arm was held to be at rest, and whether it is now known to rest.

    Returns
    -------
    count : int
        How many readings were taken in.
    x, P, rest_at, still, resting, in_cell, n_cells
        After them.
    """
    n_joint, n_channel, n = hidden.size, total.size, readings.shape[0]
    room, slope, predicted = room_of(n_joint), np.zeros((rest_noise.shape[0], x.size)), np.zeros(len(rest_noise))
    for j in range(n_joint):
        slope[n_channel + j, 3 * j + 1] = 1.0
    noise_at_rest, cells, speeds, so_far = rest_noise.copy(), window.cells.copy(), hidden.copy(), total.copy()
    judged = Window(cells, window.room_reading, window.room_slope, window.noise, window.rounding)
    taken, whole = 0, True
    while whole and taken < n:
        end = min(n, taken + cell - in_cell)
        noise = noise_at_rest if still else moving_noise
        rows, limit = noise.shape[0], limits[1] if still else limits[0]
        count, x, P = stride(
            of,
            room,
            F,
            Q,
            x,
            P,
            readings[taken:end],
            rest_at,
            still,
            noise,
            limit,
            slope[:rows],
            predicted[:rows],
            states[taken:end],
            variances[taken:end],
            sizes[taken:end],
            so_far,
        )
        whole = count == end - taken
        for k in range(taken, taken + count):
            shares[k], stills[k], restings[k] = sizes[k] / rows, still, resting
        taken, in_cell = taken + count, in_cell + count
        if in_cell < cell:
            continue
        cells[n_cells % len(cells)] = so_far / cell
        so_far[:] = 0.0
        in_cell, n_cells = 0, n_cells + 1
        if n_cells >= len(cells):
            share = unrest(of, room, judged, n_cells % len(cells), x, P, speeds)
            if share < 1.0:
                if not still:
                    rest_at = at_rest(x, n_joint)
                variance = rest_variance(speeds, dt)
                for j in range(n_joint):
                    noise_at_rest[n_channel + j, n_channel + j] = variance[j]
            still = share < 1.0
            resting = share < (TO_LEAVE if resting else 1.0)
            restings[taken - 1] = resting
    rest_noise[:], window.cells[:], hidden[:], total[:] = noise_at_rest, cells, speeds, so_far
    return taken, x, P, rest_at, still, resting, in_cell, n_cells
