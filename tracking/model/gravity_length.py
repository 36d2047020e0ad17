"""How large accelerometers' offsets may be: at rest each reads gravity, whose length is known whatever the pose.

The angles that gravity shows take up what offsets and mountings do to its direction, so only its length speaks of
offsets alone. It is taken as it is read, whatever offsets the arm file states:
those were found on another day, and with them a length that agrees would say that they are exact.
"""

import numpy as np

from arm.model import Floats
from tracking.model.observation import Observation
from tracking.model.readings import Readings
from tracking.model.zero_velocity import window_frames

#: Offsets of a sensor's axes are held to be no smaller and no larger than these, standard deviations [m/s^2].
LEAST_OFFSET_STD, MOST_OFFSET_STD = 0.02, 0.5
#: Factor on what readings show, for the standard deviation of few offsets is itself uncertain; a convention.
OFFSET_MARGIN = 2.0


def bound_offsets(of: Observation, readings: Readings, P: Floats) -> None:
    """Hold the offsets in a state's covariance to no more than the length of gravity allows.

    Parameters
    ----------
    of : Observation
    readings : Readings
    P : (n_state, n_state)
        Before the first reading; changed in place.
    """
    felt = ~of.turning & (of.corner == 0.0)
    if not felt.any():
        return
    n = of.chain.revolute.size
    offset = 3 * n + np.flatnonzero(np.repeat(felt, 3))
    calm = calmest_mean(readings)[offset - 3 * n]
    lengths = np.linalg.norm((calm / of.scale[felt].ravel()).reshape(-1, 3), axis=1)
    usual = np.sqrt(np.mean((lengths - np.linalg.norm(of.chain.gravity)) ** 2))
    std = np.clip(OFFSET_MARGIN * usual, LEAST_OFFSET_STD, MOST_OFFSET_STD)
    factor = np.ones(len(P))
    factor[offset] = np.minimum(1.0, std / np.sqrt(P[offset, offset]))
    P *= np.outer(factor, factor)


def calmest_mean(readings: Readings) -> Floats:
    """Return the mean reading of the quarter of a second in which readings change least, (n_channel,)."""
    cell, n_cell = window_frames(readings.dt_s)
    length = min(cell * n_cell, len(readings.values))
    parts = readings.values[: len(readings.values) // length * length].reshape(
        -1, length, readings.values.shape[1]
    )
    scatter = parts.std(axis=1).max(axis=1)
    if not np.isfinite(scatter).any():
        return readings.first_mean
    mean: Floats = parts[int(np.nanargmin(scatter))].mean(axis=0)
    return mean
