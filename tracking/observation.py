"""The state of a tracker, and what the sensors' readings depend on of it.

The state begins with q, dq, ddq of joint 1, then of joint 2 and so on; then follows one offset a channel; then
constants, of which each is there or not: lengths a and d of links; of each AC-coupled sensor what it would read
once it has forgotten everything, and its corner; of each sensor scale, misalignment and place. Lengths, corners
and mountings are departures from what the arm file says. Last comes what the model lacks, if it is asked for: the
acceleration of the base, in its own axes, and a difference of each channel.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, chain_of
from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats

#: Constants a sensor: three of scale, three of misalignment, three of place.
MOUNTING = 9
MOUNTING_NAMES = tuple(f"{kind}_{axis}" for kind in ("scale", "turn", "place") for axis in "xyz")
#: The column of an entry that the state does not have; compiled code asks for less than 0.
ABSENT = -1


class Observation(NamedTuple):
    """Constants of the observation; columns count from 0 in the state, `ABSENT` where it has no such entry.

    Attributes
    ----------
    chain : Chain
    link : (n_sensor,)
        The link that each sensor rides on, from 0.
    position : (n_sensor, 3)
    rotation : (n_sensor, 3, 3)
        From sensor axes to link axes.
    scale : (n_sensor, 3)
        What a sensor reads for one m/s^2.
    length_column : (n_joint, 2)
        Of a and d.
    corner : (n_sensor,) [rad/s]
        Below which a sensor forgets; 0 for one that doesn't.
    settled_column : (n_sensor,)
        The first of three: what each axis settles at.
    corner_column : (n_sensor,)
        Departure of the corner, of those that are to be estimated.
    mounting_column : (n_sensor,)
        The first of nine: scale x y z, turn about x y z of the sensor, place x y z on the link.
    base_column : int
        The first of three: the acceleration of the base, in its own axes [m/s^2].
    lack_column : int
        The first of one a channel: what the model lacks of its reading [m/s^2].
    reported : (n_reported,)
        Entries whose variance a smoother reports: joints, the base's acceleration, what the model lacks.
    columns : (3 n_sensor, n_most)
        The state's entries that a channel depends on.
    n_column : (3 n_sensor,)
        How many those are.
    """

    chain: Chain
    link: NDArray[np.int64]
    position: Floats
    rotation: Floats
    scale: Floats
    length_column: NDArray[np.int64]
    corner: Floats
    settled_column: NDArray[np.int64]
    corner_column: NDArray[np.int64]
    mounting_column: NDArray[np.int64]
    base_column: int
    lack_column: int
    reported: NDArray[np.int64]
    columns: NDArray[np.int64]
    n_column: NDArray[np.int64]


def observation_of(
    arm: Arm, mountings: bool = False, base: bool = False, lack: bool = False
) -> tuple[Observation, int]:
    """Return the observation of an arm's sensors and the size of the state.

    Parameters
    ----------
    arm : Arm
    mountings : bool
        Let the state hold scale, misalignment and place of every sensor, and the corner of AC-coupled ones.
    base, lack : bool
        Let the state hold an acceleration of the base, and what the model lacks of each channel.
    """
    n, n_sensor = arm.n_joint, len(arm.sensors)
    link = np.array([sensor.joint - 1 for sensor in arm.sensors], dtype=np.int64)
    corner = 2.0 * np.pi * np.array([sensor.highpass_hz for sensor in arm.sensors])
    size = 3 * n + 3 * n_sensor
    length_column = np.full((n, 2), ABSENT, dtype=np.int64)
    ways = [arm.way_to(int(at)) for at in link]
    for i in sorted({i for way in ways for i in way[1:]}):  # the far end of the last link moves no sensor
        before = arm.parents[i]
        if arm.joints[i].parent_position_m is None and length_column[before, 0] == ABSENT:
            length_column[before, 0], size = size, size + 1
        if arm.joints[i].type == "revolute":  # the first d moves all alike, a sliding joint's is its zero
            length_column[i, 1], size = size, size + 1
    settled_column, corner_column, mounting_column = np.full((3, n_sensor), ABSENT, dtype=np.int64)
    for s in np.flatnonzero(corner).tolist():
        settled_column[s], size = size, size + 3
        if mountings:
            corner_column[s], size = size, size + 1
    if mountings:
        mounting_column[:] = size + MOUNTING * np.arange(n_sensor, dtype=np.int64)
        size += MOUNTING * n_sensor
    base_column = ABSENT
    if base:
        base_column, size = size, size + 3
    lack_column = ABSENT
    if lack:
        lack_column, size = size, size + 3 * n_sensor
    depends: list[list[int]] = []
    for s in range(n_sensor):
        way = list(ways[s])
        a, d = length_column[way[:-1], 0], length_column[way, 1]
        shared = [*(3 * i + k for i in way for k in range(3)), *a[a != ABSENT], *d[d != ABSENT]]
        if mountings:
            shared += range(mounting_column[s], mounting_column[s] + MOUNTING)
        if base:
            shared += range(base_column, base_column + 3)
        channels = range(3 * s, 3 * s + 3)
        depends += [[*shared, 3 * n + c, *([lack_column + c] if lack else [])] for c in channels]
    columns = np.zeros((3 * n_sensor, max(map(len, depends))), dtype=np.int64)
    for channel, entries in enumerate(depends):
        columns[channel, : len(entries)] = entries
    observation = Observation(
        chain_of(arm),
        link,
        np.array([sensor.position_m for sensor in arm.sensors], dtype=float).reshape(-1, 3),
        np.array([rotation_from_rpy(*sensor.rotation_rad) for sensor in arm.sensors]).reshape(-1, 3, 3),
        np.array([sensor.scale for sensor in arm.sensors], dtype=float).reshape(-1, 3),
        length_column,
        corner,
        settled_column,
        corner_column,
        mounting_column,
        base_column,
        lack_column,
        np.array(
            [
                *range(3 * n),
                *range(base_column, base_column + 3 * base),
                *range(lack_column, lack_column + 3 * n_sensor * lack),
            ],
            dtype=np.int64,
        ),
        columns,
        np.array([len(entries) for entries in depends], dtype=np.int64),
    )
    return observation, size
