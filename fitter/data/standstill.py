"""Which joints move, by their speed: the one decision on standstill wherever the velocities of a motion are given.

Readings of accelerometers have detectors of their own (`tracking.dead_reckoning.rest`,
`tracking.model.zero_velocity`), for they show no velocity; and so has static friction (`fitter.dynamics.stands`),
which must know a joint to stand far below the speed at which it stops being of use to a fit.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter1d

from arm.model import Floats

#: What is no faster than about a degree a second [rad/s or m/s] may as well be at rest: integrated and
#: differentiated angles are not better than that.
REST_SPEED = 0.02


def is_moving(dq: Floats, rest_speed: float = REST_SPEED) -> NDArray[np.bool_]:
    """Return where joints move, in the shape of their velocities ``dq`` [rad/s or m/s]."""
    return np.asarray(np.abs(dq) > rest_speed, dtype=np.bool_)


def throughout(moving: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Return where joints move in all samples up to ``reach`` before and after, (n_sample, …).

    What a filter shows of a sample depends on those about it, and a joint that stands is held by any torque.
    """
    return np.asarray(minimum_filter1d(moving, 2 * reach + 1, axis=0, mode="nearest"), dtype=np.bool_)
