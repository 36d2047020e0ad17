"""The paper's section 2.2 as a compiled kernel: moving average of four, Euler twice, two positions an angle.

What the print leaves out: a reading is turned from its sensor's axes into the base frame, by the angles known so
far, before it is integrated, and gravity is added to the specific force.

From one sample to the next a joint turns by so little that its cosine and sine follow from the positions and from
a short series: the kernel calls no trigonometric function but once a block, and where a joint jumps.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, link_step
from arm.model import Floats
from limbcal.compiled import compiled, inlined

#: Below this angle [rad] the series are exact to rounding.
_SMALL = 3e-3


class Reckoning(NamedTuple):
    """State and constants of the dead reckoning.

    Attributes
    ----------
    chain : Chain
    link, position, rotation, pair
        As in `tracking.layout.Layout`.
    start : (n_sensor, 3)
        Where the sensors were when tracking began, by the arm file; used for sliding joints only.
    baseline : (n_joint, 3)
        From the first to the second sensor of a pair when tracking began, in the base frame.
    q, q_before : (n_joint,)
        Now and one sample ago.
    velocity, moved : (n_sensor, 3)
        In the base frame.
    recent : (4, 3 * n_sensor)
        The last four readings, for the moving average; ``recent[count % 4]`` is overwritten next.
    offset : (3 * n_sensor,)
        What the sensors read too much.
    """

    chain: Chain
    link: NDArray[np.int64]
    position: Floats
    rotation: Floats
    pair: NDArray[np.int64]
    start: Floats
    baseline: Floats
    q: Floats
    q_before: Floats
    velocity: Floats
    moved: Floats
    recent: Floats
    offset: Floats


@compiled
def reckon(
    state: Reckoning,
    readings: Floats,
    dt: float,
    resting: bool,
    first: int,
    decimation: int,
    phase: int,
    q: Floats,
    moved: Floats,
) -> int:
    """Carry the state through readings (n, 3 * n_sensor); fill in and count the frames that fall due.

    Sample number ``first + k`` makes a frame when it leaves the remainder ``phase`` by ``decimation``. While the
    arm rests, velocities stay zero and nothing moves, but the moving average goes on.
    """
    n_sensor, n_joint = state.link.size, state.q.size
    R = np.empty((n_joint, 3, 3))
    mean, a, end = np.empty(3 * n_sensor), np.empty(3), np.empty(3)
    before, pair = np.empty((n_joint, 3, 3)), np.empty((n_joint, 2))
    facing, ahead = np.empty((n_joint, 2)), np.empty((n_joint, 2))
    standing(state, before, pair, facing)
    frames = 0
    for k in range(readings.shape[0]):
        sample = first + k
        for c in range(mean.size):
            state.recent[sample % 4, c] = readings[k, c]
            total = state.recent[0, c] + state.recent[1, c] + state.recent[2, c] + state.recent[3, c]
            mean[c] = total / 4.0 - state.offset[c]  # moving average of four
        if resting:
            state.q_before[:] = state.q
        else:
            carried_on(state, facing, ahead)
            link_rotations(ahead, before, R)
            for sensor in range(n_sensor):
                turn = R[state.link[sensor]]
                for row in range(3):  # sensor axes -> link axes
                    a[row] = (
                        state.rotation[sensor, row, 0] * mean[3 * sensor]
                        + state.rotation[sensor, row, 1] * mean[3 * sensor + 1]
                        + state.rotation[sensor, row, 2] * mean[3 * sensor + 2]
                    )
                for row in range(3):  # link axes -> base frame, gravity added
                    acceleration = (
                        turn[row, 0] * a[0] + turn[row, 1] * a[1] + turn[row, 2] * a[2] + state.chain.gravity[row]
                    )
                    state.moved[sensor, row] += state.velocity[sensor, row] * dt  # x^(i+1) = x^i + dx^i dt
                    state.velocity[sensor, row] += acceleration * dt  # dx^(i+1) = dx^i + ddx^i dt
            angles(state, before, pair, R, end, facing)
        if sample % decimation == phase:
            q[frames], moved[frames] = state.q, state.moved
            frames += 1
    return frames


@compiled
def gravity_readings(state: Reckoning, readings: Floats) -> None:
    """Fill in what the sensors read of gravity alone, (3 * n_sensor,), with the joints where they are."""
    n_joint = state.q.size
    before, R = np.empty((n_joint, 3, 3)), np.empty((n_joint, 3, 3))
    facing = np.empty((n_joint, 2))
    standing(state, before, np.empty((n_joint, 2)), facing)
    link_rotations(facing, before, R)
    gravity, felt = state.chain.gravity, np.empty(3)
    for s in range(state.link.size):
        turn, axes = R[state.link[s]], state.rotation[s]
        for col in range(3):  # base frame -> link axes
            felt[col] = -(gravity[0] * turn[0, col] + gravity[1] * turn[1, col] + gravity[2] * turn[2, col])
        for col in range(3):  # link axes -> sensor axes
            readings[3 * s + col] = felt[0] * axes[0, col] + felt[1] * axes[1, col] + felt[2] * axes[2, col]


@compiled
def standing(state: Reckoning, before: Floats, pair: Floats, facing: Floats) -> None:
    """Fill in what stands at the begin of a block.

    That is a joint's Rot(y, beta) Rot(x, alpha), (n_joint, 3, 3), and cosine and sine, (n_joint, 2) each, of where
    its pair lies in its link and of how far its link is turned.
    """
    room = np.empty(3)
    for i in range(state.q.size):
        alpha, _, d, beta, offset = state.chain.geometry[i]
        one, two = state.pair[i]
        link_step(True, alpha, d, beta, 0.0, 0.0, before[i], room)
        sx = state.position[two, 0] - state.position[one, 0]
        sy = state.position[two, 1] - state.position[one, 1]
        angle = math.atan2(sy, sx)
        theta = offset + state.q[i] if state.chain.revolute[i] else offset
        pair[i, 0], pair[i, 1] = math.cos(angle), math.sin(angle)
        facing[i, 0], facing[i, 1] = math.cos(theta), math.sin(theta)


@inlined
def cosine_sine(angle: float) -> tuple[float, float]:
    """Return the cosine and the sine of an angle, most of which are small."""
    if abs(angle) > _SMALL:
        return math.cos(angle), math.sin(angle)
    square = angle * angle
    return 1.0 - square / 2.0 * (1.0 - square / 12.0), angle * (1.0 - square / 6.0 * (1.0 - square / 20.0))


@inlined
def direction(x: float, y: float) -> float:
    """Return the angle at which a point lies, most of which are small."""
    if abs(y) >= _SMALL * x:
        return math.atan2(y, x)
    slope = y / x
    square = slope * slope
    return slope * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square / 7.0)))


@inlined
def turned(X: Floats, c: float, s: float, out: Floats) -> None:
    """Fill in X Rot(z, theta), by the cosine and the sine of theta; ``out`` may be X."""
    for row in range(3):
        x, y = X[row, 0], X[row, 1]
        out[row, 0], out[row, 1], out[row, 2] = c * x + s * y, c * y - s * x, X[row, 2]


@inlined
def carried_on(state: Reckoning, facing: Floats, ahead: Floats) -> None:
    """Fill in where links will face one sample on: positions are one behind the reading that moves them on."""
    for i in range(len(facing)):
        c, s = 1.0, 0.0
        if state.chain.revolute[i]:
            c, s = cosine_sine(state.q[i] - state.q_before[i])
        ahead[i, 0] = facing[i, 0] * c - facing[i, 1] * s
        ahead[i, 1] = facing[i, 1] * c + facing[i, 0] * s


@inlined
def link_rotations(facing: Floats, before: Floats, R: Floats) -> None:
    """Fill in how every link is turned, R (n_joint, 3, 3), by the cosines and sines of how each one is."""
    for i in range(len(facing)):
        if i == 0:
            turned(before[0], facing[0, 0], facing[0, 1], R[0])
        else:
            multiply(R[i - 1], before[i], R[i])
            turned(R[i], facing[i, 0], facing[i, 1], R[i])


@inlined
def angles(state: Reckoning, before: Floats, pair: Floats, R: Floats, end: Floats, facing: Floats) -> None:
    """Find the joint variables from where the sensors have come to, link by link from the base.

    ``end`` (3,) has room for the far end of the link before.
    """
    geometry = state.chain.geometry
    state.q_before[:] = state.q
    end[:] = 0.0
    for i in range(state.q.size):
        a, d = geometry[i, 1], geometry[i, 2]
        one, two = state.pair[i]
        if i == 0:
            R[0] = before[0]
        else:
            multiply(R[i - 1], before[i], R[i])  # the link but for its turning
        if state.chain.revolute[i]:
            x = y = 0.0
            for row in range(3):
                u = state.baseline[i, row] + state.moved[two, row] - state.moved[one, row]
                x += R[i, row, 0] * u
                y += R[i, row, 1] * u
            length = math.sqrt(x * x + y * y)
            if length > 0.0:  # the angle that turns one pair onto the other
                c = (x * pair[i, 0] + y * pair[i, 1]) / length
                s = (y * pair[i, 0] - x * pair[i, 1]) / length
                was_c, was_s = facing[i]
                state.q[i] += direction(was_c * c + was_s * s, was_c * s - was_s * c)  # by the nearest turn
                facing[i, 0], facing[i, 1] = c, s
            slid = d
        turned(R[i], facing[i, 0], facing[i, 1], R[i])
        if not state.chain.revolute[i]:
            z = 0.0
            for row in range(3):
                at = end[row] + d * R[i, row, 2]
                for col in range(3):
                    at += R[i, row, col] * state.position[one, col]
                z += R[i, row, 2] * (state.start[one, row] + state.moved[one, row] - at)
            state.q[i] = z
            slid = d + z
        for row in range(3):
            end[row] += slid * R[i, row, 2] + a * R[i, row, 0]


@inlined
def multiply(A: Floats, B: Floats, out: Floats) -> None:
    """Fill in the product of two 3 x 3 matrices; ``out`` is neither of them."""
    for row in range(3):
        for col in range(3):
            out[row, col] = A[row, 0] * B[0, col] + A[row, 1] * B[1, col] + A[row, 2] * B[2, col]
