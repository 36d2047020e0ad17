r"""How fast an arm may be when a recording begins: as fast as the first readings change with it.

An arm whose readings stay what they are rests. People sway and stands shake, so readings mostly change a little.
While an angle is :math:`q_0 + vt + at^2/2`, gravity's direction changes by what the angle does. Over a window T a
speed v changes it by :math:`vT/4` at the least, with the acceleration that hides most of it, :math:`-2v/T`; and an
acceleration a by :math:`aT^2/8`, with the speed that does, :math:`-aT/2`.
What the readings changed by bounds both.
"""

from typing import NamedTuple

import numpy as np

from arm.model import Floats
from tracking.model.noise import Noise
from tracking.model.zero_velocity import WINDOW_S, unsteadiness, window_frames, window_of

#: Speed and acceleration of an arm at rest [rad/s, rad/s^2; or m/s, m/s^2]: about half a degree a second,
#: conventions.
RESTING_SPEED_STD = 1e-2
RESTING_STDS = RESTING_SPEED_STD, 0.05
#: And of one of which nothing is known. Joints of robots turn at up to 3 rad/s (data sheets of UR5e, LBR iiwa),
#: elbows at up to 20 rad/s in a throw, four times this; it takes half a second to get there.
MOVING_STDS = 5.0, 10.0
#: Speed and acceleration for an angle that changes by one, at the most.
_MOST_SPEED, _MOST_ACCELERATION = 4.0 / WINDOW_S, 8.0 / WINDOW_S**2
#: Standard deviation of what is anywhere within a bound, as a share of it.
_UNIFORM = 1.0 / np.sqrt(3.0)


class FirstReadings(NamedTuple):
    """The readings of the first quarter of a second.

    Attributes
    ----------
    mean : (n_channel,)
    change : (n_channel,)
        How far apart means over a hundredth of a second are; 0 if they are as near as those of an arm at rest, and
        infinite where they are not all there.
    """

    mean: Floats
    change: Floats

    @property
    def steady(self) -> bool:
        """Whether they stay what they are."""
        return not self.change.any()


def resting(mean: Floats) -> FirstReadings:
    """Return first readings that stay what they are."""
    return FirstReadings(mean, np.zeros(len(mean)))


def first_readings(values: Floats, dt_s: float, noise: Noise, factor: int) -> FirstReadings:
    """Return what the first readings of a recording are.

    Parameters
    ----------
    values : (n, n_channel)
    dt_s, noise, factor
        As in `tracking.model.readings.Readings`.
    """
    cell, n_cell = window_frames(dt_s)
    first = values[: n_cell * cell]
    mean = first[~np.isnan(first[:, 0])].mean(axis=0)
    if len(first) < n_cell * cell or np.isnan(first).any():
        return FirstReadings(mean, np.full(len(mean), np.inf))
    window = window_of(n_cell, 1, noise.of_mean(factor * cell), noise.rounding)
    window.cells[:] = first.reshape(n_cell, cell, -1).mean(axis=1)
    change = np.ptp(window.cells, axis=0)
    return resting(mean) if unsteadiness(window, 0) < 1.0 else FirstReadings(mean, change)


def begin_stds(first: FirstReadings, slope: Floats) -> tuple[Floats, Floats]:
    """Return standard deviations of every joint's speed and acceleration when a recording begins, (n_joint,) each.

    Parameters
    ----------
    first : FirstReadings
    slope : (n_channel, n_joint)
        Of what is read, by the angles.
    """
    n = slope.shape[1]
    if first.steady:
        return np.full(n, RESTING_STDS[0]), np.full(n, RESTING_STDS[1])
    seen = slope / max(float(first.change[slope.any(axis=1)].max(initial=0.0)), np.finfo(np.float64).tiny)
    stds = []
    for most, least, factor in zip(MOVING_STDS, RESTING_STDS, (_MOST_SPEED, _MOST_ACCELERATION), strict=True):
        information = seen.T @ seen / (_UNIFORM * factor) ** 2 + np.eye(n) / most**2
        stds.append(np.maximum(np.sqrt(np.diag(np.linalg.inv(information))), least))
    return stds[0], stds[1]
