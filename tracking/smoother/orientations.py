"""How sensors are turned, of the 24 ways in which a sensor's axes can be exchanged and reversed against its file.

Sensors are taken in one after the other, from the base outwards, each in all 24 ways, and the likeliest few
combinations are kept (a beam search; B. T. Lowerre 1976). A combination is as likely as the motion of the links so
far that explains the readings of the sensors so far best (`tracking.smoother.rough_motion`), with noise as large
as what is left. Right ways leave what misplaced sensors and a rough model leave; wrong ones leave as much as
gravity.

In long frames accelerations do not change evenly, and gains and lengths make up for it. So a likely combination
whose lengths and places come out far from their guesses is fitted again in frames half as long, until they come
out near or frames are as short as the smoother's first ones: what the frames' length does goes with it, what a
wrong combination needs does not.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import permutations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import rotation_from_rpy, rpy_from_rotation
from arm.model import Arm, Floats
from tracking.model.initial_state import GUESSED_STD, MountingPrior, rest_residual
from tracking.model.noise import Noise
from tracking.model.observation import observation_of
from tracking.model.readings import Readings
from tracking.smoother.coarsening import stride_of
from tracking.smoother.rough_motion import RATE_HZ, rough_motion

#: Combinations that are kept from sensor to sensor; and if none of them is near, a second time.
_BEAMS = (8, 32)
#: Of the run so much counts, from its first sample on [s]: a rest and some motion of every joint.
_SECONDS = 12.0
#: An accelerometer's offset [m/s^2]; log-odds at which a combination is not looked at further.
_OFFSET_STD, _IMPOSSIBLE_NATS = 0.5, 20.0
#: Log-odds within which two combinations are equally likely: a hundred to one.
EQUAL_NATS = float(np.log(100.0))


@cache
def right_angles() -> Floats:
    """Return the 24 rotations that take axes to axes, (24, 3, 3), the one that leaves them first; read only."""
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            R = np.zeros((3, 3))
            R[list(order), range(3)] = signs
            if np.linalg.det(R) > 0.0:
                found.append(R)
    found.sort(key=lambda R: -np.trace(R))
    rotations = np.array(found)
    rotations.flags.writeable = False
    return rotations


class Turned(NamedTuple):
    """Sensors turned against the file.

    ``ways`` is the number of the rotation of each. ``is_near`` says that lengths and places are then where they
    were held to be, within what they may be off: a sensor that faces backwards on the other side of its joint
    reads the same where nothing shows the joint's zero. ``log_prior`` is that of the angles in which the arm was
    first, up to a constant: a flat upright arm reads the same from behind.
    """

    ways: tuple[int, ...]
    log_likelihood: float
    is_near: bool
    log_prior: float = 0.0


def turned(arm: Arm, ways: tuple[int, ...]) -> Arm:
    """Return the arm with its first sensors turned, each in one of the 24 ways."""
    rotations = right_angles()
    sensors = list(arm.sensors)
    for s, way in enumerate(ways):
        R = rotation_from_rpy(*sensors[s].rotation_rad) @ rotations[way]
        roll, pitch, yaw = (float(angle) for angle in rpy_from_rotation(R))
        sensors[s] = replace(sensors[s], rotation_rad=(roll, pitch, yaw))
    return replace(arm, sensors=tuple(sensors))


def likely_orientations(
    arm: Arm,
    readings: Readings,
    q: Floats,
    given: bool,
    prior: MountingPrior,
    progress: Callable[[int], None] | None = None,
) -> list[Turned]:
    """Return the likeliest combinations of orientations, the likeliest first.

    Parameters
    ----------
    arm, q, given
        As of `tracking.smoother.smoother.Smoother`.
    readings : Readings
    prior : MountingPrior
        How far off the sensors may be besides.
    progress : callable, optional
        Told how many combinations were tried, after each sensor.
    """
    order = np.argsort([sensor.joint for sensor in arm.sensors], kind="stable")
    part, some = _part(arm, order), _of_channels(readings, order)
    finest: list[Turned] = []
    for width in _BEAMS:
        beam = _beam(arm, readings, q, given, prior, order, width, progress)
        q0 = q[: part.n_joint]
        finest = [Turned(ways, *_log_likelihood(turned(part, ways), some, q0, given, prior)) for ways in beam]
        most = max(one.log_likelihood for one in finest)
        finest = [
            one._replace(is_near=_is_near_in_shorter_frames(turned(part, one.ways), some, q0, given, prior))
            if not one.is_near and one.log_likelihood > most - EQUAL_NATS
            else one
            for one in finest
        ]
        finest.sort(key=lambda one: (not one.is_near, -one.log_likelihood))
        if finest[0].is_near:
            break
    back = np.argsort(order)
    return [one._replace(ways=tuple(one.ways[k] for k in back)) for one in finest]


def log_likelihood(arm: Arm, readings: Readings, q: Floats, given: bool, prior: MountingPrior) -> float:
    """Return how likely the readings of the same stretch are if sensors are as an arm says, within a prior."""
    order = np.arange(len(arm.sensors))
    part = _part(arm, order)
    found, near, _ = _log_likelihood(part, _of_channels(readings, order), q[: part.n_joint], given, prior)
    return found if near else -np.inf


def _beam(
    arm: Arm,
    readings: Readings,
    q: Floats,
    given: bool,
    prior: MountingPrior,
    order: NDArray[np.intp],
    width: int,
    progress: Callable[[int], None] | None,
) -> list[tuple[int, ...]]:
    """Return the likeliest combinations if places and lengths are as they were guessed, sensors in an order."""
    beam, tried = list[tuple[int, ...]]([()]), 0
    for count in range(1, len(order) + 1):
        part, some = _part(arm, order[:count]), _of_channels(readings, order[:count])
        tries: list[tuple[int, ...]] = [(*before, way) for before in beam for way in range(len(right_angles()))]
        q0 = q[: part.n_joint]
        if some.begins_steadily:
            tries = _at_rest(part, some, q0, given, prior, tries)
        likely = [_log_likelihood(turned(part, ways), some, q0, given, None)[0] for ways in tries]
        beam = [tries[k] for k in np.argsort(likely)[::-1][:width]]
        tried += len(tries)
        if progress is not None:
            progress(tried)
    return beam


def _at_rest(
    arm: Arm, readings: Readings, q: Floats, given: bool, prior: MountingPrior, tries: list[tuple[int, ...]]
) -> list[tuple[int, ...]]:
    """Return the combinations that explain the first rest no worse than the best one does."""
    first = readings.first_mean
    g = float(np.linalg.norm(arm.gravity_m_s2))
    std = np.hypot(_OFFSET_STD, prior.turn_rad * g)
    left = np.empty(len(tries))
    for k, ways in enumerate(tries):
        of, size = observation_of(turned(arm, ways))
        left[k] = np.sum(rest_residual(of, size, first, q, given) ** 2) / std**2
    return [ways for ways, square in zip(tries, left, strict=True) if square < left.min() + 2.0 * _IMPOSSIBLE_NATS]


def _is_near_in_shorter_frames(arm: Arm, readings: Readings, q: Floats, given: bool, prior: MountingPrior) -> bool:
    """Say whether lengths and mountings are near in frames half as long as the rough ones, or shorter."""
    rate_hz, last_hz = RATE_HZ, 1.0 / (stride_of(readings.dt_s) * readings.dt_s)
    while rate_hz < last_hz:
        rate_hz = min(2.0 * rate_hz, last_hz)
        found = rough_motion(arm, readings, q, given, prior, rate_hz)
        if found is not None and found.is_near:
            return True
    return False


def _log_likelihood(
    arm: Arm, readings: Readings, q: Floats, given: bool, prior: MountingPrior | None
) -> tuple[float, bool, float]:
    """Return how likely readings are, the noise being as large as what the likeliest motion leaves of them.

    The second is whether lengths and mountings are near, where ``prior`` lets mountings be sought, the third the
    logarithm of the prior of the first angles that are not given.
    """
    found = rough_motion(arm, readings, q, given, prior)
    if found is None:
        return -np.inf, False, 0.0
    if given:
        return found.log_likelihood, found.is_near, 0.0
    away = found.states[0, : 3 * arm.n_joint : 3] - q
    revolute = np.array([joint.type == "revolute" for joint in arm.joints])
    away = np.where(revolute, np.remainder(away + np.pi, 2.0 * np.pi) - np.pi, away)
    return found.log_likelihood, found.is_near, -0.5 * float(np.sum(away**2)) / GUESSED_STD**2


def _part(arm: Arm, taken: NDArray[np.intp]) -> Arm:
    """Return the arm as far as some of its sensors, in their order; accelerometers say how they are turned."""
    sensors = tuple(replace(arm.sensors[k], gyroscope=None) for k in taken)
    return replace(arm, joints=arm.joints[: max(sensor.joint for sensor in sensors)], sensors=sensors, tip=None)


def _of_channels(readings: Readings, taken: NDArray[np.intp]) -> Readings:
    """Return the first readings of some accelerometers, in their order."""
    columns = np.ravel(3 * np.asarray(taken)[:, None] + np.arange(3))
    noise = readings.noise
    least = np.broadcast_to(noise.least, noise.variance.shape)[columns]
    noise = Noise(noise.variance[columns], noise.rounding[columns], least)
    rows = round(_SECONDS / readings.dt_s)
    return replace(readings, values=readings.values[:rows, columns], noise=noise)
