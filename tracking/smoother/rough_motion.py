"""A rough motion that any arm has: the readings' noise is as large as what the likeliest motion leaves of them.

A few steps of Gauss and Newton from a filter that begins with noise as large as the readings themselves, so that
it believes little but gravity. What a sensor gets wrong bends such a motion, but does not break it.
"""

from typing import NamedTuple

import numpy as np

from arm.model import Arm, Floats
from tracking.kalman.plain_filter import filter_plainly
from tracking.model.course import course_of
from tracking.model.discrepancy import speed_rate
from tracking.model.expected_readings import room_of
from tracking.model.initial_state import ROUGH, MountingPrior, start_state
from tracking.model.observation import observation_of
from tracking.model.process_noise import SMOOTHER_PUSH_STD
from tracking.model.readings import Readings
from tracking.smoother.coarsening import coarser
from tracking.smoother.smoothed import is_near
from tracking.smoother.smoothing_pass import pass_of, smooth_once

#: Frames a second that show the motion of an arm [Hz].
RATE_HZ = 30.0
#: Steps of Gauss and Newton, and the most where mountings are sought as well.
_STEPS, _LAST_STEPS = 2, 15
#: Speed of a joint before anything is known of it [rad/s or m/s].
_USUAL_SPEED = 2.0
#: A step that gains less than a hundred to one is the last [nats].
_LEAST_GAIN = float(np.log(100.0))


class RoughMotion(NamedTuple):
    """A rough motion.

    Attributes
    ----------
    states : (n, n_state)
        Of frames that are each ``stride`` of the readings'.
    stride : int
    log_likelihood : float
        Of the readings, up to a constant [nats].
    is_near : bool
        Lengths and mountings are within what they were held to be off.
    """

    states: Floats
    stride: int
    log_likelihood: float
    is_near: bool


def rough_motion(
    arm: Arm,
    readings: Readings,
    q: Floats,
    given: bool,
    prior: MountingPrior | None = None,
    rate_hz: float = RATE_HZ,
) -> RoughMotion | None:
    """Return a rough motion, or None if there is none.

    Parameters
    ----------
    arm, q, given
        As of `tracking.smoother.smoother.Smoother`.
    readings : Readings
    prior : MountingPrior, optional
        Mountings and lengths are sought within it; without it they are as the arm has them.
    rate_hz : float
        Frames a second.
    """
    of, size = observation_of(arm, mountings=prior is not None)
    x0, P0 = start_state(arm, of, size, readings.first, q, given, prior or ROUGH)
    n = arm.n_joint
    push = np.full(n, SMOOTHER_PUSH_STD**2)
    course = course_of(readings, n)._replace(push=push, rate=speed_rate(push, np.full(n, _USUAL_SPEED)))
    stride = max(1, round(1.0 / (rate_hz * readings.dt_s)))
    course = coarser(course, stride)
    least = course.noise
    variance = np.maximum(np.var(course.readings[course.present], axis=0).mean(), least)
    course = course._replace(noise=variance)
    room, found = room_of(n), pass_of(of, course, size)
    try:
        at = filter_plainly(of, course, x0, P0)
        x, cost, before = x0, np.inf, np.inf
        for _ in range(_STEPS if prior is None else _LAST_STEPS):
            x, P = x0.copy(), P0.copy()
            cost = smooth_once(of, room, course, at, x, P, found, False)
            if not np.isfinite(found.states).all():
                return None
            at = found.states.copy()
            left = course.noise * found.error[:, : course.noise.size]
            course = course._replace(noise=np.maximum(np.mean(left[course.present] ** 2), least))
            if abs(cost - before) < 2.0 * _LEAST_GAIN:
                break
            before = cost
    except np.linalg.LinAlgError:
        return None
    if not np.isfinite(cost):
        return None
    near = prior is None or is_near(of, x - x0, P0)
    return RoughMotion(at, stride, -0.5 * float(cost), near)
