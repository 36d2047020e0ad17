"""What the sensors should read in a state, and how that changes with it: compiled, one instant at a time."""

from typing import NamedTuple

import numpy as np

from arm.chain import Chain, poses
from arm.model import Floats
from arm.newton_euler import base_axes, rigid_motion
from arm.reading_slopes import SEEDS, at_lever, lever_slope, motion_slopes, row, total
from arm.triple import cross, turned_back
from limbcal.compiled import compiled
from tracking.model.observation import Observation

#: The three axes of a sensor.
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Room(NamedTuple):
    """What `observe` works in, so that it need not ask for memory at every instant."""

    zero_p: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    R: Floats
    p: Floats
    motion: Floats
    slopes: Floats
    gravity: Floats
    axes: Floats


@compiled
def room_of(n: int) -> Room:
    """Return room for an arm of n joints."""
    return Room(
        np.empty((n, 3)),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty((n, 3, 3)),
        np.empty((n, 3)),
        np.empty((n, 3, 3)),
        np.zeros((n, SEEDS * n, 3, 3)),
        np.empty(3),
        np.empty((3, 3)),
    )


@compiled
def move_arm(of: Observation, room: Room, x: Floats) -> None:
    """Fill in the poses, the motion of all links and its slopes in state x."""
    n = room.q.size
    plain = of.chain
    room.zero_p[:] = plain.zero_p
    for j in range(n):
        room.q[j], room.dq[j], room.ddq[j] = x[3 * j], x[3 * j + 1], x[3 * j + 2]
        before, d = plain.parent[j], of.length_column[j, 1]
        if before >= 0 and of.length_column[before, 0] >= 0:  # eq. (1): a of the link that it hangs on
            room.zero_p[j, 0] += plain.hang[j, 0] * x[of.length_column[before, 0]]
        if d >= 0:
            for i in range(3):
                room.zero_p[j, i] += x[d] * plain.zero_R[j, i, 2]
    chain = Chain(
        plain.revolute,
        plain.geometry,
        plain.inertial,
        plain.friction,
        plain.gravity,
        plain.drag,
        plain.parent,
        plain.hang,
        plain.zero_R,
        room.zero_p,
    )  # fmt: skip
    poses(chain, room.q, room.R, room.p)
    room.gravity[:] = chain.gravity
    if of.base_column >= 0:  # a base that accelerates upwards adds to what gravity is felt as
        for i in range(3):
            room.gravity[i] -= x[of.base_column + i]
    rigid_motion(chain, room.gravity, room.R, room.p, room.dq, room.ddq, room.motion)
    motion_slopes(chain, room.R, room.p, room.motion, room.dq, room.slopes)


@compiled
def observe(of: Observation, room: Room, x: Floats, reading: Floats, slope: Floats) -> None:
    """Fill in what every channel reads in state x, (3 n_triad,), and its slopes, (3 n_triad, n_state).

    Only those entries of ``slope`` are written that `Observation.columns` names.
    """
    n = room.q.size
    move_arm(of, room, x)
    for s in range(of.link.size):
        if of.turning[s]:
            observe_turning(of, room, x, s, reading, slope)
            continue
        channel, link, rotation = 3 * s, of.link[s], of.rotation[s]
        first = of.mounting_column[s]
        w, dw = row(room.motion[link, 0]), row(room.motion[link, 1])
        px, py, pz = row(of.position[s])
        gx, gy, gz = row(of.scale[s])
        turn = (0.0, 0.0, 0.0)
        if first >= 0:
            gx, gy, gz = gx + x[first], gy + x[first + 1], gz + x[first + 2]
            turn = row(x[first + 3 : first + 6])
            px, py, pz = px + x[first + 6], py + x[first + 7], pz + x[first + 8]
        place, gain = (px, py, pz), (gx, gy, gz)
        lever, dv = at_lever(w, dw, place), row(room.motion[link, 2])
        upright = turned_back(rotation, (dv[0] + lever[0], dv[1] + lever[1], dv[2] + lever[2]))
        felt = turned_by(turn, upright)
        for c in range(3):
            reading[channel + c] = gain[c] * felt[c] + x[3 * n + channel + c]
            slope[channel + c, 3 * n + channel + c] = 1.0
            if of.lack_column >= 0:
                reading[channel + c] += x[of.lack_column + channel + c]
                slope[channel + c, of.lack_column + channel + c] = 1.0
        i = link
        while i >= 0:
            for k in range(SEEDS):
                column = 3 * i + k if k < 3 else of.length_column[i, k - 3]
                if column < 0 or (k == 3 and i == link):
                    continue
                t = room.slopes[link, SEEDS * i + k]
                swing, tdv = lever_slope(w, row(t[0]), row(t[1]), place), row(t[2])
                a = (tdv[0] + swing[0], tdv[1] + swing[1], tdv[2] + swing[2])
                a = turned_by(turn, turned_back(rotation, a))
                for c in range(3):
                    slope[channel + c, column] = gain[c] * a[c]
            i = of.chain.parent[i]
        own = felt
        if of.base_column >= 0:
            base_axes(of.chain.parent, room.R, link, room.axes)
            base_slopes(room.axes, rotation, turn, gain, slope[channel : channel + 3], of.base_column)
            without = base_taken_away(room.axes, x, of.base_column)
            own = total(felt, turned_by(turn, turned_back(rotation, without)))
        if first >= 0:
            mounting_slopes(rotation, turn, gain, felt, own, w, dw, slope[channel : channel + 3], first)


@compiled
def observe_turning(of: Observation, room: Room, x: Floats, s: int, reading: Floats, slope: Floats) -> None:
    """Fill in what gyroscope s reads, ``G Exp(turn)^T R^T omega + o``, and its slopes, once the arm is moved."""
    n, channel, link, rotation = room.q.size, 3 * s, of.link[s], of.rotation[s]
    gain, turn = row(of.scale[s]), (0.0, 0.0, 0.0)
    scale, first = of.gyro_scale_column[s], of.mounting_column[s]
    if scale >= 0:
        gain = total(gain, row(x[scale : scale + 3]))
        turn = row(x[first + 3 : first + 6])
    felt = turned_by(turn, turned_back(rotation, row(room.motion[link, 0])))
    for c in range(3):
        reading[channel + c] = gain[c] * felt[c] + x[3 * n + channel + c]
        slope[channel + c, 3 * n + channel + c] = 1.0
        if of.lack_column >= 0:
            reading[channel + c] += x[of.lack_column + channel + c]
            slope[channel + c, of.lack_column + channel + c] = 1.0
    i = link
    while i >= 0:
        for k in range(2):  # by angle and by speed
            w = turned_by(turn, turned_back(rotation, row(room.slopes[link, SEEDS * i + k, 0])))
            for c in range(3):
                slope[channel + c, 3 * i + k] = gain[c] * w[c]
        i = of.chain.parent[i]
    if scale >= 0:
        for k in range(3):
            turned = cross(felt, turned_further(turn, AXES[k]))
            for c in range(3):
                slope[channel + c, scale + k] = felt[c] if c == k else 0.0
                slope[channel + c, first + 3 + k] = gain[c] * turned[c]


@compiled
def base_slopes(
    link_axes: Floats,
    rotation: Floats,
    turn: tuple[float, float, float],
    gain: tuple[float, float, float],
    slope: Floats,
    first: int,
) -> None:
    """Fill in the slopes (3, n_state) of one sensor by the acceleration of the base.

    ``link_axes`` (3, 3) are the axes of its link in the base frame, as columns.
    """
    for i in range(3):
        a = turned_by(turn, turned_back(rotation, row(link_axes[i])))
        for c in range(3):
            slope[c, first + i] = gain[c] * a[c]


@compiled
def base_taken_away(link_axes: Floats, x: Floats, first: int) -> tuple[float, float, float]:
    """Return the acceleration of the base with its sign reversed, in the axes of a link, see `base_slopes`.

    Slopes by scale are of what is felt without the base. How it moves is learnt from the readings, and sensors
    never quite share it: a frame that rocks moves the farther one more. A gain would stand for that.
    """
    bx, by, bz = x[first], x[first + 1], x[first + 2]
    return (
        -bx * link_axes[0, 0] - by * link_axes[1, 0] - bz * link_axes[2, 0],
        -bx * link_axes[0, 1] - by * link_axes[1, 1] - bz * link_axes[2, 1],
        -bx * link_axes[0, 2] - by * link_axes[1, 2] - bz * link_axes[2, 2],
    )


@compiled
def mounting_slopes(
    rotation: Floats,
    turn: tuple[float, float, float],
    gain: tuple[float, float, float],
    felt: tuple[float, float, float],
    own: tuple[float, float, float],
    w: tuple[float, float, float],
    dw: tuple[float, float, float],
    slope: Floats,
    first: int,
) -> None:
    """Fill in the slopes (3, n_state) of one sensor by its scale, turn and place.

    It feels ``felt``, and ``own`` of that if the base stands.
    """
    for k in range(3):
        turned = cross(felt, turned_further(turn, AXES[k]))
        moved = turned_by(turn, turned_back(rotation, at_lever(w, dw, AXES[k])))
        for c in range(3):
            slope[c, first + k] = own[c] if c == k else 0.0
            slope[c, first + 3 + k] = gain[c] * turned[c]
            slope[c, first + 6 + k] = gain[c] * moved[c]


@compiled
def turned_by(turn: tuple[float, float, float], a: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a vector as a sensor sees it that is turned by a small rotation vector: ``Exp(turn)^T a``."""
    if turn[0] == 0.0 and turn[1] == 0.0 and turn[2] == 0.0:
        return a
    angle = np.sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
    s, c = np.sin(angle) / angle, (1.0 - np.cos(angle)) / angle**2
    one = cross(turn, a)
    two = cross(turn, one)
    return a[0] - s * one[0] + c * two[0], a[1] - s * one[1] + c * two[1], a[2] - s * one[2] + c * two[2]


@compiled
def turned_further(
    turn: tuple[float, float, float], more: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return the small rotation, in the turned axes, that a rotation vector makes of itself by a little ``more``.

    ``Exp(turn + more) = Exp(turn) Exp(J more)`` with the right Jacobian J (J. Sola and others 2018, eq. 143).
    Without it turn and place of a sensor that no motion tells apart would seem to be, where the turn is large.
    """
    if turn[0] == 0.0 and turn[1] == 0.0 and turn[2] == 0.0:
        return more
    angle = np.sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
    s, c = (angle - np.sin(angle)) / angle**3, 2.0 * (np.sin(0.5 * angle) / angle) ** 2
    one = cross(turn, more)
    two = cross(turn, one)
    return more[0] - c * one[0] + s * two[0], more[1] - c * one[1] + s * two[1], more[2] - c * one[2] + s * two[2]


@compiled
def add_information(of: Observation, noise: Floats, slopes: Floats, A: Floats) -> None:
    """Add to A (n_joint, n_joint) what readings with variances ``noise`` tell of an instant's accelerations."""
    for channel in range(noise.size):
        slope = slopes[channel]
        for j in range(of.link[channel // 3] + 1):
            for i in range(of.link[channel // 3] + 1):
                A[i, j] += slope[3 * i + 2] * slope[3 * j + 2] / noise[channel]
