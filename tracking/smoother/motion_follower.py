"""One motion after the other, smoothed, with draws of what is wrong with each: how well a motion is known.

Each motion is smoothed from the rest before it to the rest after it, and begins with what the motion before it
left known of angles, offsets and lengths. Draws of the errors are carried along
(`tracking.smoother.linear_response`): what all motions share, such as a sensor's offset, is shared by a draw of
all motions too.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import sensor_positions
from arm.model import Arm, Floats
from limbcal.errors import DataError
from tracking.model.course import Course
from tracking.model.draws import DRAWS, Draws
from tracking.model.expected_readings import room_of
from tracking.model.observation import ABSENT, Observation
from tracking.model.readings import Readings
from tracking.model.sensor_paths import SensorPaths
from tracking.smoother.linear_response import respond
from tracking.smoother.smoother import Smoother

#: Angles that a tracker says have changed by more than this moved while nobody looked [rad or m].
_MOVED = 0.02
#: For how long joints move on to show the velocity of a point [s].
_STEP_S = 1e-3


@dataclass(frozen=True)
class KnownMotion:
    """A motion and how well it is known.

    Attributes
    ----------
    dt_s : float
    q, dq, ddq : (n, n_joint)
    points : (n, n_sensor, 3) [m]
    still : (n,) bool
        The arm was held to be at rest.
    draws : Draws
        Its points are of the sensors that `MotionFollower` was asked for.
    doubted : float
        Share of the instants at which the readings contradict the arm.
    """

    dt_s: float
    q: Floats
    dq: Floats
    ddq: Floats
    points: Floats
    still: NDArray[np.bool_]
    draws: Draws
    doubted: float


class MotionFollower:
    """Smooths an arm's motions one after the other.

    Parameters
    ----------
    arm : Arm
    seed : int
        Of the draws.
    sensors : tuple of int
        Whose points are drawn.
    """

    def __init__(self, arm: Arm, seed: int, sensors: tuple[int, ...]) -> None:
        self._arm, self._rng, self._sensors = arm, np.random.default_rng([seed, 3]), sensors
        self._state: tuple[Floats, Floats] | None = None
        self._errors = np.zeros((0, 0))
        self._told = np.zeros(arm.n_joint)

    def follow(self, readings: Readings, q: Floats, q_std: Floats | None, end_q: Floats) -> KnownMotion:
        """Smooth a motion.

        Parameters
        ----------
        readings : Readings
            From the rest before the motion to the rest after it.
        q, q_std : (n_joint,)
            Where a tracker says the arm rests before it, and how well it knows that if it says so.
        end_q : (n_joint,)
            And where it rests after it.

        Raises
        ------
        DataError
            If no motion of the arm explains the readings, or they are of other sensors.
        """
        if readings.values.shape[1] < self._arm.n_channel:  # dead reckoning gives out no gyroscopes
            self._arm = self._arm.with_gyroscopes(())
        if readings.values.shape[1] != self._arm.n_channel:
            found, expected = readings.values.shape[1], self._arm.n_channel
            raise DataError(
                f"readings of {found} channels, expected {expected} as {self._arm.name!r}'s sensors have"
            )
        n, n_channel = self._arm.n_joint, readings.values.shape[1]
        smoother = Smoother(self._arm, q, False)
        start = self._start(smoother, readings, q, q_std)
        self._told = end_q
        found = smoother.smooth(readings, start=start)
        course = found.course
        noise = self._noise(course)
        errors = np.empty((len(course.readings), 3 * n + n_channel, DRAWS))
        P = start[1].copy()
        respond(smoother.observation, room_of(n), course, found.along, P, self._errors, noise, errors)
        self._state = found.final, found.covariance
        states = found.states
        q, dq, ddq = (states[:, k : 3 * n : 3].copy() for k in range(3))
        offset = states[:, 3 * n : 3 * n + n_channel]
        felt = (readings.values - offset)[:, : 3 * len(self._arm.sensors)]
        points = SensorPaths(self._arm, readings.dt_s).follow(q, felt, found.still)
        off = np.moveaxis(errors, 2, 0)
        drawn = Draws(
            q - off[:, :, : 3 * n : 3],
            dq - off[:, :, 1 : 3 * n : 3],
            ddq - off[:, :, 2 : 3 * n : 3],
            np.empty((DRAWS, len(q), len(self._sensors), 3)),
        )
        arm = replace(self._arm, sensors=tuple(self._arm.sensors[s] for s in self._sensors))
        columns = np.ravel([range(3 * s, 3 * s + 3) for s in self._sensors]).astype(np.intp)
        felt = felt[:, columns]
        for d in range(DRAWS):
            less = noise[:, columns, d] - off[d][:, 3 * n + columns]
            drawn.points[d] = SensorPaths(arm, readings.dt_s).follow(drawn.q[d], felt - less, found.still)
        _creep(_with_lengths(arm, smoother.observation, found.final), drawn, found.still, readings.dt_s)
        return KnownMotion(readings.dt_s, q, dq, ddq, points, found.still, drawn, found.doubted)

    def _start(
        self, smoother: Smoother, readings: Readings, q: Floats, q_std: Floats | None
    ) -> tuple[Floats, Floats]:
        """Return state and covariance before a motion, and draw the errors of what is not known of it yet."""
        n = self._arm.n_joint
        if self._state is None or np.any(np.abs(q - self._told) > _MOVED):
            x, P = smoother.begin(readings)
            if q_std is not None:
                known = np.diag_indices(3 * n)[0][::3]
                P[known, known] = np.maximum(P[known, known], q_std**2)
            errors = np.linalg.cholesky(P + 1e-18 * np.eye(len(P))) @ self._rng.standard_normal((len(P), DRAWS))
            if self._state is not None:
                lasting = slice(3 * n, None)
                x[lasting], P[lasting, lasting] = self._state[0][lasting], self._state[1][lasting, lasting]
                errors[lasting] = self._errors[lasting]
            self._errors = errors
            return x, P
        return self._state

    def _noise(self, course: Course) -> Floats:
        """Draw errors of readings, white and of offsets that wander, and speeds at rest, (n, n_row, n_draw)."""
        n, n_channel = course.readings.shape
        drawn = self._rng.standard_normal((2, n, n_channel, DRAWS)) * np.sqrt(
            np.stack([course.noise, course.wander * course.dt])
        ).reshape(2, 1, n_channel, 1)
        speeds = self._rng.standard_normal((n, course.push.size, DRAWS)) * np.sqrt(course.rest)[:, :, None]
        return np.concatenate([drawn[0] + np.cumsum(drawn[1], axis=0), speeds], axis=1)


def _with_lengths(arm: Arm, of: Observation, state: Floats) -> Arm:
    """Return the arm with its lengths as far as the smoother knows them."""
    lengths = np.array([[joint.a_m, joint.d_m] for joint in arm.joints])
    known = of.length_column != ABSENT
    lengths[known] += state[of.length_column[known]]
    return arm.with_joints(a_m=lengths[:, 0], d_m=lengths[:, 1])


def _creep(arm: Arm, drawn: Draws, still: NDArray[np.bool_], dt_s: float) -> None:
    """Let the points of each draw leave a rest as fast as its joints crept there: paths begin with no velocity."""
    for begin in np.flatnonzero(still[:-1] & ~still[1:]):
        ends = np.flatnonzero(still[begin + 1 :])
        end = begin + 1 + int(ends[0]) if len(ends) else len(still)
        moving = dt_s * np.minimum(np.arange(len(still) - begin), end - begin)
        q, dq = drawn.q[:, begin], drawn.dq[:, begin]
        velocity = (sensor_positions(arm, q + _STEP_S * dq) - sensor_positions(arm, q)) / _STEP_S
        drawn.points[:, begin:] += velocity[:, None] * moving[:, None, None]
