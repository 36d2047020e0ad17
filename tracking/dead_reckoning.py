"""The paper's section 2.2 as a compiled kernel: moving average of four, Euler twice, two positions an angle.

What the print leaves out: a reading is turned from its sensor's axes into the base frame, by the angles known so
far, before it is integrated, and gravity is added to the specific force.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain, link_step
from arm.model import Floats
from limbcal.compiled import compiled


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
    mean, a, carried = np.empty(3 * n_sensor), np.empty(3), np.empty(n_joint)
    before, pair_angle, end = np.empty((n_joint, 3, 3)), np.empty(n_joint), np.empty(3)
    standing(state, before, pair_angle)
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
            for i in range(n_joint):  # positions are one sample behind the reading that moves them on
                carried[i] = 2.0 * state.q[i] - state.q_before[i]
            link_rotations(state, carried, before, R)
            for s in range(n_sensor):
                turn = R[state.link[s]]
                for row in range(3):  # sensor axes -> link axes
                    a[row] = (
                        state.rotation[s, row, 0] * mean[3 * s]
                        + state.rotation[s, row, 1] * mean[3 * s + 1]
                        + state.rotation[s, row, 2] * mean[3 * s + 2]
                    )
                for row in range(3):  # link axes -> base frame, gravity added
                    acceleration = (
                        turn[row, 0] * a[0] + turn[row, 1] * a[1] + turn[row, 2] * a[2] + state.chain.gravity[row]
                    )
                    state.moved[s, row] += state.velocity[s, row] * dt  # x^(i+1) = x^i + dx^i dt
                    state.velocity[s, row] += acceleration * dt  # dx^(i+1) = dx^i + ddx^i dt
            angles(state, before, pair_angle, R, end)
        if sample % decimation == phase:
            q[frames], moved[frames] = state.q, state.moved
            frames += 1
    return frames


@compiled
def gravity_readings(state: Reckoning, readings: Floats) -> None:
    """Fill in what the sensors read of gravity alone, (3 * n_sensor,), with the joints where they are."""
    n_joint = state.q.size
    before, R = np.empty((n_joint, 3, 3)), np.empty((n_joint, 3, 3))
    standing(state, before, np.empty(n_joint))
    link_rotations(state, state.q, before, R)
    gravity, felt = state.chain.gravity, np.empty(3)
    for s in range(state.link.size):
        turn, axes = R[state.link[s]], state.rotation[s]
        for col in range(3):  # base frame -> link axes
            felt[col] = -(gravity[0] * turn[0, col] + gravity[1] * turn[1, col] + gravity[2] * turn[2, col])
        for col in range(3):  # link axes -> sensor axes
            readings[3 * s + col] = felt[0] * axes[0, col] + felt[1] * axes[1, col] + felt[2] * axes[2, col]


@compiled
def standing(state: Reckoning, before: Floats, angle: Floats) -> None:
    """Fill in what does not change: a joint's Rot(y, beta) Rot(x, alpha), and where its pair lies in its link."""
    room = np.empty(3)
    for i in range(state.q.size):
        alpha, _, d, beta, _ = state.chain.geometry[i]
        one, two = state.pair[i]
        link_step(True, alpha, d, beta, 0.0, 0.0, before[i], room)
        sx = state.position[two, 0] - state.position[one, 0]
        sy = state.position[two, 1] - state.position[one, 1]
        angle[i] = math.atan2(sy, sx)


@compiled
def turned(X: Floats, theta: float, out: Floats) -> None:
    """Fill in X Rot(z, theta); ``out`` may be X."""
    c, s = math.cos(theta), math.sin(theta)
    for row in range(3):
        x, y = X[row, 0], X[row, 1]
        out[row, 0], out[row, 1], out[row, 2] = c * x + s * y, c * y - s * x, X[row, 2]


@compiled
def link_rotations(state: Reckoning, q: Floats, before: Floats, R: Floats) -> None:
    """Fill in how every link is turned at joint variables q, R (n_joint, 3, 3)."""
    for i in range(q.size):
        theta = state.chain.geometry[i, 4]
        if state.chain.revolute[i]:
            theta += q[i]
        if i == 0:
            turned(before[0], theta, R[0])
        else:
            multiply(R[i - 1], before[i], R[i])
            turned(R[i], theta, R[i])


@compiled
def angles(state: Reckoning, before: Floats, pair_angle: Floats, R: Floats, end: Floats) -> None:
    """Find the joint variables from where the sensors have come to, link by link from the base.

    ``end`` (3,) has room for the far end of the link before.
    """
    geometry = state.chain.geometry
    state.q_before[:] = state.q
    end[:] = 0.0
    for i in range(state.q.size):
        a, d, offset = geometry[i, 1], geometry[i, 2], geometry[i, 4]
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
            # The angle that turns one pair onto the other.
            turn = math.atan2(y, x) - pair_angle[i] - offset - state.q[i]
            state.q[i] += turn - 2.0 * math.pi * math.floor(turn / (2.0 * math.pi) + 0.5)  # the nearest turn
            turned(R[i], offset + state.q[i], R[i])
            slid = d
        else:
            turned(R[i], offset, R[i])
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


@compiled
def multiply(A: Floats, B: Floats, out: Floats) -> None:
    """Fill in the product of two 3 x 3 matrices; ``out`` is neither of them."""
    for row in range(3):
        for col in range(3):
            out[row, col] = A[row, 0] * B[0, col] + A[row, 1] * B[1, col] + A[row, 2] * B[2, col]
