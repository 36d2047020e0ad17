"""What is held of the state before the first reading."""

from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats, SensorCovariance, Vector3
from limbcal.compiled import borrowed, compiled
from tracking.model.expected_readings import Room, observe, room_of
from tracking.model.first_rest import MOVING_STDS, FirstReadings, begin_stds
from tracking.model.gravity_length import LEAST_OFFSET_STD, MOST_OFFSET_STD, OFFSET_MARGIN
from tracking.model.observation import ABSENT, GYRO_SCALE_NAMES, MOUNTING, MOUNTING_NAMES, Observation

#: An accelerometer's offset where nothing is known of it [m/s^2].
_OFFSET_STD = 0.2
#: A gyroscope's offset: six degrees a second, as data sheets of consumers' chips have it [rad/s].
_RATE_OFFSET_STD = 0.1
#: An AC-coupled one may stand anywhere, and what it settles at is read off while it has settled [m/s^2].
_UNSETTLED_STD, _SETTLED_STD = 20.0, 0.002
#: How well an angle is known that was given, and one that was not [rad or m]; those that readings don't show are
#: the zero.
GIVEN_STD, GUESSED_STD = 0.01, 1.0
#: An angle that is the zero by definition [rad or m]: as little as keeps a covariance from being singular.
_EXACT_STD = 1e-5
#: Steps of Gauss and Newton to level angles at the most, and a step that is none [rad].
_LEVEL_STEPS, _LEVEL_RAD = 20, 1e-9
#: A length that the arm file does not say the accuracy of is held to a share of itself, of this at the least [m].
_LEAST_LENGTH_STD_M = 0.1
#: A corner is known to a third, as resistors and capacitors are.
_CORNER_SHARE = 0.3


@dataclass(frozen=True)
class MountingPrior:
    """How carefully sensors are mounted and made: standard deviations.

    ``place_share`` is that of each coordinate of a place as a share of it, besides ``place_m``; ``length_share``
    that of a length of which the arm file does not say how well it is known.
    """

    scale: float = 0.01
    turn_rad: float = 0.0175
    place_m: float = 0.002
    place_share: float = 0.0
    length_share: float = 1.0 / 3.0

    def stds(self, position_m: Vector3) -> Floats:
        """Return those of scale, turn and place of a sensor that sits somewhere, (9,)."""
        place = np.hypot(self.place_m, self.place_share * np.asarray(position_m))
        return np.concatenate([np.full(3, self.scale), np.full(3, self.turn_rad), place])


#: Sensors that were mounted by eye, ten degrees and a centimetre, whose places and lengths are guesses to a third.
ROUGH = MountingPrior(turn_rad=0.175, place_m=0.01, place_share=0.3, length_share=0.3)


def start_state(
    arm: Arm,
    of: Observation,
    size: int,
    first: FirstReadings,
    q: Floats,
    given: bool,
    mounting: MountingPrior,
) -> tuple[Floats, Floats]:
    """Return state and covariance before the first reading.

    Parameters
    ----------
    arm : Arm
    of, size
        As from `tracking.model.observation.observation_of`.
    first : FirstReadings
        They say how fast the arm may be.
    q : (n_joint,)
        Where the arm is when tracking begins.
    given : bool
        Somebody measured ``q``; otherwise gravity is asked first, as far as it shows an angle and readings do not
        change. Angles that gravity does not show of an arm at rest are ``q`` by definition; of an arm that moves
        only those that no motion shows.
    mounting : MountingPrior

    Returns
    -------
    x : (n_state,)
    P : (n_state, n_state)
    """
    n, n_sensor = arm.n_joint, len(arm.sensors)
    x, P = np.zeros(size), np.zeros((size, size))
    bias = [sensor.bias_m_s2 for sensor in arm.sensors]
    bias += [sensor.gyroscope.bias_rad_s for sensor in arm.sensors if sensor.gyroscope is not None]
    coupled, turning = np.repeat(of.corner > 0.0, 3), np.repeat(of.turning, 3)
    offset = slice(3 * n, 3 * n + 3 * of.link.size)
    x[offset] = np.array(bias, dtype=float).ravel()
    offset_std = _offset_std(of)
    x[: 3 * n : 3] = q if given else _level(of, x, first.mean, np.hypot(offset_std, first.change), q)
    reading, slope = _read(of, x)
    lasting = ~coupled & ~turning
    left, free = (first.mean - reading)[lasting], np.count_nonzero(lasting) - n
    if first.steady and free > 0:
        usual = np.sqrt(np.sum(left**2) / free)
        offset_std[lasting] = np.clip(OFFSET_MARGIN * usual, LEAST_OFFSET_STD, MOST_OFFSET_STD)
    x[offset] += np.where(coupled, first.mean - reading, 0.0)
    speed_std, acceleration_std = begin_stds(first, slope[:, : 3 * n : 3])
    if not first.steady:
        slope = _in_motion(of, x)
    # a motion shows an angle by how readings change, whatever an AC-coupled sensor stands at
    told_to = offset_std if first.steady else np.minimum(offset_std, _OFFSET_STD)
    # given angles were measured some time before the first frame
    unshown = GIVEN_STD if given and not first.steady else _EXACT_STD
    shown = GIVEN_STD if given else GUESSED_STD
    P[: 3 * n : 3, : 3 * n : 3] = _angle_covariance(slope[:, : 3 * n : 3] / told_to[:, None], shown, unshown)
    std = np.zeros(size)
    std[offset] = offset_std
    std[1 : 3 * n : 3], std[2 : 3 * n : 3] = speed_std, acceleration_std
    for joint, columns in zip(arm.joints, of.length_column, strict=True):
        for length, column in zip((joint.a_m, joint.d_m), columns, strict=True):
            if column != ABSENT:
                guess = mounting.length_share * max(abs(length), _LEAST_LENGTH_STD_M)
                std[column] = guess if joint.length_std_m is None else joint.length_std_m
    for s in range(n_sensor):
        if of.settled_column[s] != ABSENT:
            settled = slice(of.settled_column[s], of.settled_column[s] + 3)
            x[settled], std[settled] = first.mean[3 * s : 3 * s + 3], _SETTLED_STD
        if of.corner_column[s] != ABSENT:
            std[of.corner_column[s]] = _CORNER_SHARE * of.corner[s]
        if of.mounting_column[s] != ABSENT:
            begin = of.mounting_column[s]
            std[begin : begin + MOUNTING] = mounting.stds(arm.sensors[s].position_m)
    for begin in of.gyro_scale_column[of.gyro_scale_column != ABSENT]:
        std[begin : begin + 3] = mounting.scale
    P += np.diag(std**2)
    if arm.sensor_covariance is not None:
        _take_over(arm, of, arm.sensor_covariance, P)
    return x, P


def rest_residual(of: Observation, size: int, first: Floats, q: Floats, given: bool) -> Floats:
    """Return what gravity leaves unexplained of the first readings of an arm at rest, (n_channel,)."""
    x = np.zeros(size)
    n, offset_std = q.size, np.full(first.size, _OFFSET_STD)
    x[: 3 * n : 3] = q if given else _level(of, x, first, offset_std, q)
    left: Floats = first - _read(of, x)[0]
    return left


def _offset_std(of: Observation) -> Floats:
    """Return the standard deviation of each channel's offset where nothing is known of it, (n_channel,)."""
    std: Floats = np.where(of.turning, _RATE_OFFSET_STD, np.where(of.corner > 0.0, _UNSETTLED_STD, _OFFSET_STD))
    return np.repeat(std, 3)


def _take_over(arm: Arm, of: Observation, known: SensorCovariance, P: Floats) -> None:
    """Put what a calibration knows of scales, turns and places into a covariance; offsets are of each day."""
    columns, places = [], []
    for place, parameter in enumerate(known.parameters):
        sensor, _, number = parameter.rpartition(" ")
        column = _constant_column(arm, of, arm.sensor_index(sensor), number)
        if column != ABSENT:
            columns.append(column)
            places.append(place)
    P[np.ix_(columns, columns)] = known.matrix()[np.ix_(places, places)]


def _constant_column(arm: Arm, of: Observation, s: int, number: str) -> int:
    """Return the column of a sensor's scale, turn, place or gyroscope's scale; `ABSENT` if there is none."""
    if number in MOUNTING_NAMES and of.mounting_column[s] != ABSENT:
        return int(of.mounting_column[s]) + MOUNTING_NAMES.index(number)
    if number in GYRO_SCALE_NAMES and s in arm.gyroscopes:
        first = int(of.gyro_scale_column[len(arm.sensors) + arm.gyroscopes.index(s)])
        return ABSENT if first == ABSENT else first + GYRO_SCALE_NAMES.index(number)
    return ABSENT


def _read(of: Observation, x: Floats) -> tuple[Floats, Floats]:
    """Return what is read in a state, and its slopes; most of what is asked here is asked of an arm at rest."""
    n_channel = 3 * of.link.size
    reading, slope = np.empty(n_channel), np.zeros((n_channel, x.size))
    observe(of, room_of(of.chain.revolute.size), x, reading, slope)
    return reading, slope


def _in_motion(of: Observation, x: Floats) -> Floats:
    """Return the slopes of what is read of an arm that moves as fast as one may, (n_channel, n_state)."""
    n, moving = of.chain.revolute.size, x.copy()
    moving[1 : 3 * n : 3], moving[2 : 3 * n : 3] = MOVING_STDS
    return _read(of, moving)[1]


def _level(of: Observation, x: Floats, first: Floats, offset_std: Floats, q: Floats) -> Floats:
    """Return the angles at which gravity explains what is read at rest, the nearest to ``q``."""
    found: Floats = q.copy()
    _step_to_level(of, room_of(q.size), x.copy(), first, offset_std, q, found)
    return found


@compiled
def _step_to_level(
    of: Observation, room: Room, x: Floats, first: Floats, offset_std: Floats, q: Floats, found: Floats
) -> None:
    """Move the angles ``found`` by Gauss and Newton's steps of half a radian at the most; ``x`` is used up."""
    of, room = borrowed(of), borrowed(room)  # the caller keeps them
    n, n_channel = q.size, first.size
    reading, slope = np.empty(n_channel), np.zeros((n_channel, x.size))
    A, b = np.empty((n, n)), np.empty(n)
    for _ in range(_LEVEL_STEPS):
        x[: 3 * n : 3] = found
        observe(of, room, x, reading, slope)
        A[:] = np.eye(n) / GUESSED_STD**2
        b[:] = (q - found) / GUESSED_STD**2
        for channel in range(n_channel):
            weight, miss = offset_std[channel] ** -2, first[channel] - reading[channel]
            for i in range(n):
                b[i] += slope[channel, 3 * i] * miss * weight
                for j in range(n):
                    A[i, j] += slope[channel, 3 * i] * slope[channel, 3 * j] * weight
        step = np.linalg.solve(A, b)
        for i in range(n):
            found[i] += min(max(step[i], -0.5), 0.5)
        if np.abs(step).max() < _LEVEL_RAD:
            break


def _angle_covariance(H: Floats, shown: float, unshown: float) -> Floats:
    """Return the angles' covariance by the standard deviations of what readings show of them and what not."""
    information, axes = np.linalg.eigh(H.T @ H)
    seen = information * GUESSED_STD**2 > 1.0
    covariance: Floats = (axes * np.where(seen, shown**2, unshown**2)) @ axes.T
    return covariance
