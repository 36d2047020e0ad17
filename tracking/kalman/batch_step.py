"""Several frames of the live filter in one go, for as long as nothing happens: compiled.

A thousand frames a second leave no time to hand the arm to a kernel for each of their steps.
"""

import math

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.kalman.extended_kalman import correct, predict
from tracking.model.expected_readings import Room, observe
from tracking.model.observation import Observation


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
