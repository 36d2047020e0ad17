"""The paper's section 2.2 as a compiled kernel: moving average of four, Euler twice, two positions an angle.

What the print leaves out: a reading is turned from its sensor's axes into the base frame, by the angles known so
far, before it is integrated, and gravity is added to the specific force.
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled, inlined
from tracking.dead_reckoning.integration_state import Reckoning
from tracking.dead_reckoning.joint_angles import angles, carried_on, link_rotations, standing


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
    arm rests, velocities stay zero and nothing moves, but the moving average goes on. At the end
    ``state.gravity`` is of where the joints have come to.
    """
    n, n_joint = readings.shape[0], state.q.size
    felt = np.empty((0 if resting else n, readings.shape[1]))
    before, R = np.empty((n_joint, 3, 3)), np.empty((n_joint, 3, 3))
    pair, facing, ahead = np.empty((n_joint, 2)), np.empty((n_joint, 2)), np.empty((n_joint, 2))
    end = np.empty(3)
    if resting:
        remember(state, readings[max(0, n - 4) :], first + max(0, n - 4))
        state.q_before[:] = state.q
    else:
        in_link_axes(state, readings, first, felt)
        standing(state, before, pair, facing)
    frames = 0
    for k in range(n):
        if not resting:
            carried_on(state, facing, ahead)
            link_rotations(ahead, before, R)
            integrate(state, felt, k, R, dt)
            angles(state, before, pair, R, end, facing)
        if (first + k) % decimation == phase:
            q[frames], moved[frames] = state.q, state.moved
            frames += 1
    if not resting:
        gravity_readings(state)
    return frames


@inlined
def remember(state: Reckoning, readings: Floats, first: int) -> None:
    """Keep readings for the moving average; ``first`` is the number of the first of them."""
    for k in range(readings.shape[0]):
        for c in range(readings.shape[1]):
            state.recent[(first + k) % 4, c] = readings[k, c]


@inlined
def in_link_axes(state: Reckoning, readings: Floats, first: int, felt: Floats) -> None:
    """Fill in the moving average of the readings, less the offset, in the axes of the sensors' links."""
    recent, rotation, offset = state.recent, state.rotation, state.offset
    mean = np.empty(offset.size)
    for k in range(readings.shape[0]):
        slot = (first + k) % 4
        for c in range(offset.size):
            recent[slot, c] = readings[k, c]
        for c in range(offset.size):
            mean[c] = (recent[0, c] + recent[1, c] + recent[2, c] + recent[3, c]) / 4.0 - offset[c]
        for s in range(state.link.size):
            for row in range(3):
                felt[k, 3 * s + row] = (
                    rotation[s, row, 0] * mean[3 * s]
                    + rotation[s, row, 1] * mean[3 * s + 1]
                    + rotation[s, row, 2] * mean[3 * s + 2]
                )


@inlined
def integrate(state: Reckoning, felt: Floats, k: int, R: Floats, dt: float) -> None:
    """Carry velocities and positions through one sample, felt in link axes where links are turned by R."""
    gravity, velocity, moved = state.chain.gravity, state.velocity, state.moved
    for s in range(state.link.size):
        i = state.link[s]
        x, y, z = felt[k, 3 * s], felt[k, 3 * s + 1], felt[k, 3 * s + 2]
        for row in range(3):  # link axes -> base frame, gravity added
            acceleration = R[i, row, 0] * x + R[i, row, 1] * y + R[i, row, 2] * z + gravity[row]
            moved[s, row] += velocity[s, row] * dt  # x^(i+1) = x^i + dx^i dt
            velocity[s, row] += acceleration * dt  # dx^(i+1) = dx^i + ddx^i dt


@compiled
def gravity_readings(state: Reckoning) -> None:
    """Fill in what the sensors read of gravity alone, with the joints where they are."""
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
            state.gravity[3 * s + col] = felt[0] * axes[0, col] + felt[1] * axes[1, col] + felt[2] * axes[2, col]
