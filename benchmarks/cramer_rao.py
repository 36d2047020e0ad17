"""The least that a tracker could be off: the Cramér–Rao bound on the joint angles.

It is the Bayesian bound (H. L. Van Trees, *Detection, Estimation, and Modulation Theory*, 1968) of the smoother's
own problem: the inverse of the information in all readings together with what is held of the state beforehand, the
readings being linearised along the true motion and their covariance being that of the true noise. Nothing is
estimated from data. It is the variance of the error averaged over that noise and those priors.

What it knows is what the smoother may know: each frame's reading with the white noise and rounding of the mean of
its samples; accelerations that wander as the smoother's do, and may jump where they truly jump; that the arm rests
where it truly rests, by the smoother's model of a rest; offsets and lengths that are constants, as far off
beforehand as the smoother takes them to be, and so the mountings of the sensors where they are sought. It knows
neither the arm's masses nor its control nor its targets; a tracker that did could do better.

It bounds what the smoother can expect by what it holds beforehand, and the bench is kinder than that: a rest is
exact, where the smoother allows for a speed that noise could hide; lengths and given angles are the arm file's and
the truth. A tracker's errors may therefore be somewhat less than this bound, on the average too; the smoother's
claims, which rest on the same beliefs, should be close to it.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.accelerometer import specific_force
from arm.bench import SensorErrors, with_errors
from arm.counts import COUNT_M_S2
from arm.model import Arm, Floats
from tracking.model.course import course_of
from tracking.model.expected_readings import room_of
from tracking.model.first_rest import resting
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.noise import Noise
from tracking.model.observation import Observation, observation_of
from tracking.model.process_noise import SMOOTHER_PUSH_STD
from tracking.model.readings import Readings
from tracking.model.zero_velocity import WINDOW_S, rest_variance, unrest, window_frames, window_of
from tracking.smoother.smoothed import mend
from tracking.smoother.smoothing_pass import pass_of, smooth_once

#: An arm rests where no joint is faster [rad/s or m/s].
_REST_SPEED = 1e-3
#: An acceleration jumps where it changes by this many standard deviations of its wandering.
_JUMP_SIGMAS = 5.0


def least_std(
    arm: Arm, errors: SensorErrors, states: Floats, dt_s: float, factor: int, given: bool, mountings: bool
) -> Floats:
    """Return the smallest standard deviation of each angle that the readings allow.

    Parameters
    ----------
    arm : Arm
        As its file has it.
    errors : SensorErrors
        What the sensors' true errors are.
    states : (n, 3 n_joint)
        True q, dq, ddq of joint 1, then of joint 2 and so on, at every frame.
    dt_s : float
        From frame to frame.
    factor : int
        Samples a frame.
    given : bool
        Somebody measured the angles at the start.
    mountings : bool
        Scale, misalignment and place of the sensors are not known either.

    Returns
    -------
    (n, n_joint) [rad or m]
    """
    n, n_channel = arm.n_joint, 3 * len(arm.sensors)
    placed = with_errors(arm, replace(errors, bias_m_s2=np.zeros_like(errors.bias_m_s2)))
    of, size = observation_of(placed, mountings)
    at = np.zeros((len(states), size))
    at[:, : 3 * n] = states
    at[:, 3 * n : 3 * n + n_channel] = np.ravel([sensor.bias_m_s2 for sensor in placed.sensors])
    at[:, 3 * n : 3 * n + n_channel] += errors.bias_m_s2.ravel()
    q, dq, ddq = (np.ascontiguousarray(states[:, k::3]) for k in range(3))
    felt = specific_force(placed, q, dq, ddq) * np.array([sensor.scale for sensor in placed.sensors])
    values = felt.reshape(len(states), -1) + at[:, 3 * n : 3 * n + n_channel]
    variance = np.full(n_channel, errors.noise_m_s2**2 + COUNT_M_S2**2 / 12.0)
    readings = Readings(values, dt_s, factor // 2 * dt_s / factor, Noise(variance, np.zeros(n_channel)), factor)
    held = observation_of(arm, mountings)[0]
    x, P = start_state(arm, held, size, resting(readings.first_mean), q[0], given, MountingPrior())
    jumps = np.abs(np.diff(ddq, axis=0, prepend=ddq[:1]))
    course = course_of(readings, n)._replace(
        push=np.full(n, SMOOTHER_PUSH_STD**2),
        jolt=np.where(jumps > _JUMP_SIGMAS * SMOOTHER_PUSH_STD * np.sqrt(dt_s), jumps**2, 0.0),
        rest=_rests(of, readings, at, P, np.abs(dq).max(axis=1) < _REST_SPEED),
    )
    found = pass_of(of, course, at.shape[1])
    smooth_once(of, room_of(n), course, at, x, P, found, True)
    mend(found.variance)
    std: Floats = np.sqrt(found.variance[:, ::3])
    return std


def _rests(of: Observation, readings: Readings, at: Floats, P: Floats, resting: NDArray[np.bool_]) -> Floats:
    """Return the variance of velocities' being zero, (n, n_joint); 0 where the arm moves."""
    n = of.chain.revolute.size
    cell, n_cell = window_frames(readings.dt_s)
    cell_noise = readings.noise.of_mean(readings.factor * cell)
    window = window_of(n_cell, at.shape[1], cell_noise, readings.noise.rounding)
    rest, hidden = np.zeros((len(at), n)), np.zeros(n)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], resting, [False]])))
    for begin, end in edges.reshape(-1, 2):
        if (end - begin) * readings.dt_s >= WINDOW_S:  # passing zero is no rest
            unrest(of, room_of(n), window, 0, at[begin], P, hidden)
            rest[begin:end] = rest_variance(hidden, readings.dt_s)
    return rest
