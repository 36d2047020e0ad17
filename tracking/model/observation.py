"""The state of a tracker, and what the sensors' readings depend on of it.

Channels come in triads, the three axes of an accelerometer or of a gyroscope: first those of all accelerometers,
then those of the gyroscopes that there are. A gyroscope shares axes and clock of the accelerometer in its housing.

The state begins with q, dq, ddq of joint 1, then of joint 2 and so on; then follows one offset a channel; then
constants, of which each is there or not: lengths a and d of links; of each AC-coupled sensor what it would read
once it has forgotten everything, and its corner; of each sensor scale, misalignment and place; of each gyroscope
its scale. Lengths, corners and mountings are departures from what the arm file says. If they are asked for, then
come by how much the sensors' clocks are late, and last what the model lacks: the acceleration of the base, in its
own axes, and a difference of each channel.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, chain_of
from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats

#: Constants a sensor: three of scale, three of misalignment, three of place.
MOUNTING = 9
MOUNTING_NAMES = tuple(f"{kind}_{axis}" for kind in ("scale", "turn", "place") for axis in "xyz")
#: Constants of a gyroscope, beside the turn that it shares.
GYRO_SCALE_NAMES = tuple(f"gyro_scale_{axis}" for axis in "xyz")
#: The column of an entry that the state does not have; compiled code asks for less than 0.
ABSENT = -1


class Observation(NamedTuple):
    """Constants of the observation; columns count from 0 in the state, `ABSENT` where it has no such entry.

    Attributes
    ----------
    chain : Chain
    link : (n_triad,)
        The link that each triad rides on, from 0.
    turning : (n_triad,) bool
        It is a gyroscope, which measures the angular velocity of its link [rad/s], and no accelerometer, which
        measures the specific force at its place [m/s^2].
    position : (n_triad, 3)
    rotation : (n_triad, 3, 3)
        From sensor axes to link axes.
    scale : (n_triad, 3)
        What it reads for one m/s^2 or rad/s.
    length_column : (n_joint, 2)
        Of a and d.
    corner : (n_triad,) [rad/s]
        Below which a sensor forgets; 0 for one that doesn't.
    settled_column : (n_triad,)
        The first of three: what each axis settles at.
    corner_column : (n_triad,)
        Departure of the corner, of those that are to be estimated.
    mounting_column : (n_triad,)
        The first of nine: scale x y z, turn about x y z of the sensor, place x y z on the link. Of a gyroscope
        those of its accelerometer, with which it shares the turn.
    gyro_scale_column : (n_triad,)
        The first of three: scale of a gyroscope.
    clock_column : (n_triad,)
        By how much a sensor is later than its readings were taken for [s]; the first one's clock counts.
    base_column : int
        The first of three: the acceleration of the base, in its own axes [m/s^2].
    lack_column : int
        The first of one a channel: what the model lacks of its reading [m/s^2 or rad/s].
    reported : (n_reported,)
        Entries whose variance a smoother reports: joints, the base's acceleration, what the model lacks.
    columns : (3 n_triad, n_most)
        The state's entries that a channel depends on.
    n_column : (3 n_triad,)
        How many those are.
    """

    chain: Chain
    link: NDArray[np.int64]
    turning: NDArray[np.bool_]
    position: Floats
    rotation: Floats
    scale: Floats
    length_column: NDArray[np.int64]
    corner: Floats
    settled_column: NDArray[np.int64]
    corner_column: NDArray[np.int64]
    mounting_column: NDArray[np.int64]
    gyro_scale_column: NDArray[np.int64]
    clock_column: NDArray[np.int64]
    base_column: int
    lack_column: int
    reported: NDArray[np.int64]
    columns: NDArray[np.int64]
    n_column: NDArray[np.int64]


def observation_of(
    arm: Arm, mountings: bool = False, base: bool = False, lack: bool = False, clocks: Sequence[int] = ()
) -> tuple[Observation, int]:
    """Return the observation of an arm's sensors and the size of the state.

    Parameters
    ----------
    arm : Arm
    mountings : bool
        Let the state hold scale, misalignment and place of every sensor, the corner of AC-coupled ones and the
        scale of gyroscopes.
    base, lack : bool
        Let the state hold an acceleration of the base, and what the model lacks of each channel.
    clocks : sequence of int
        Let the state hold by how much these sensors are late, see `other_clocks`.
    """
    n, n_sensor = arm.n_joint, len(arm.sensors)
    housing = [*range(n_sensor), *arm.gyroscopes]  # the sensor that each triad belongs to
    sensors, n_triad = [arm.sensors[s] for s in housing], len(housing)
    turning = np.arange(n_triad) >= n_sensor
    link = np.array([sensor.joint - 1 for sensor in sensors], dtype=np.int64)
    corner = 2.0 * np.pi * np.array([sensor.highpass_hz for sensor in sensors]) * ~turning
    size = 3 * n + 3 * n_triad
    length_column = np.full((n, 2), ABSENT, dtype=np.int64)
    ways = [arm.way_to(int(at)) for at in link]
    for i in sorted({i for way in ways for i in way[1:]}):  # the far end of the last link moves no sensor
        before = arm.parents[i]
        if arm.joints[i].parent_position_m is None and length_column[before, 0] == ABSENT:
            length_column[before, 0], size = size, size + 1
        if arm.joints[i].type == "revolute":  # the first d moves all alike, a sliding joint's is its zero
            length_column[i, 1], size = size, size + 1
    settled_column, corner_column, mounting_column, gyro_scale_column = np.full(
        (4, n_triad), ABSENT, dtype=np.int64
    )
    for s in np.flatnonzero(corner).tolist():
        settled_column[s], size = size, size + 3
        if mountings:
            corner_column[s], size = size, size + 1
    if mountings:
        mounting_column[:] = size + MOUNTING * np.array(housing, dtype=np.int64)
        size += MOUNTING * n_sensor
        gyro_scale_column[turning] = size + 3 * np.arange(n_triad - n_sensor)
        size += 3 * (n_triad - n_sensor)
    clock_column = np.full(n_triad, ABSENT, dtype=np.int64)
    for sensor in clocks:
        clock_column[np.array(housing) == sensor], size = size, size + 1
    base_column, size = (size, size + 3) if base else (ABSENT, size)
    lack_column, size = (size, size + 3 * n_triad) if lack else (ABSENT, size)
    scales = [sensor.scale for sensor in arm.sensors]
    scales += [sensor.gyroscope.scale for sensor in arm.sensors if sensor.gyroscope is not None]
    observation = Observation(
        chain_of(arm),
        link,
        turning,
        np.array([sensor.position_m for sensor in sensors], dtype=float).reshape(-1, 3),
        np.array([rotation_from_rpy(*sensor.rotation_rad) for sensor in sensors]).reshape(-1, 3, 3),
        np.array(scales, dtype=float).reshape(-1, 3),
        length_column,
        corner,
        settled_column,
        corner_column,
        mounting_column,
        gyro_scale_column,
        clock_column,
        base_column,
        lack_column,
        np.array(
            [
                *range(3 * n),
                *range(base_column, base_column + 3 * base),
                *range(lack_column, lack_column + 3 * n_triad * lack),
            ],
            dtype=np.int64,
        ),
        np.zeros((0, 0), dtype=np.int64),
        np.zeros(0, dtype=np.int64),
    )
    entries = [each for s, way in enumerate(ways) for each in _entries(observation, s, list(way))]
    columns = np.zeros((3 * n_triad, max(map(len, entries))), dtype=np.int64)
    for channel, each in enumerate(entries):
        columns[channel, : len(each)] = each
    n_column = np.array([len(each) for each in entries], dtype=np.int64)
    return observation._replace(columns=columns, n_column=n_column), size


def other_clocks(arm: Arm) -> tuple[int, ...]:
    """Return the sensors whose clocks can be asked for: all but the first one, whose clock counts."""
    return tuple(range(1, len(arm.sensors)))


def _entries(of: Observation, s: int, way: list[int]) -> list[list[int]]:
    """Return the state's entries that each channel of a triad depends on; ``way`` has the links up to its own."""
    first, clock = int(of.mounting_column[s]), int(of.clock_column[s])
    shared = [] if clock == ABSENT else [clock]
    if of.turning[s]:  # by angles and speeds alone
        scale = int(of.gyro_scale_column[s])
        mounted = [] if first == ABSENT else [*range(first + 3, first + 6), *range(scale, scale + 3)]
        shared = [*(3 * i + k for i in way for k in range(2)), *mounted, *shared]
    else:
        a, d = of.length_column[way[:-1], 0], of.length_column[way, 1]
        mounted = [] if first == ABSENT else [*range(first, first + MOUNTING)]
        felt = [*(3 * i + k for i in way for k in range(3)), *a[a != ABSENT], *d[d != ABSENT]]
        base = [] if of.base_column == ABSENT else [*range(of.base_column, of.base_column + 3)]
        shared = [*felt, *mounted, *shared, *base]
    offset = 3 * of.chain.revolute.size
    lack = [] if of.lack_column == ABSENT else [of.lack_column]
    return [[*shared, offset + c, *(at + c for at in lack)] for c in range(3 * s, 3 * s + 3)]


def channels_alike(of: Observation) -> list[slice]:
    """Return the channels of all accelerometers and, if there are any, those of all gyroscopes."""
    first, n_channel = 3 * int(np.count_nonzero(~of.turning)), 3 * of.link.size
    return [part for part in (slice(0, first), slice(first, n_channel)) if part.start < part.stop]


def rms_alike(of: Observation, values: Floats) -> Floats:
    """Return the root of the mean square of values (n, n_channel) over all channels of a kind, (n_channel,)."""
    parts = channels_alike(of)
    return np.concatenate(
        [np.full(part.stop - part.start, np.sqrt(np.square(values[:, part]).mean())) for part in parts]
    )
