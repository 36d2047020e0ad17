"""Joint angles from where the sensors have come to: two positions a link, link by link from the base; compiled.

From one sample to the next a joint turns by so little that its cosine and sine follow from the positions and from
a short series: no trigonometric function is called but once a block, and where a joint jumps.

Matrices are written element by element: a view of one, taken for each sample, costs more than all of its numbers.
"""

import math

import numpy as np

from arm.chain import link_step
from arm.model import Floats
from limbcal.compiled import compiled, inlined
from tracking.dead_reckoning.integration_state import Reckoning

#: Below this angle [rad] the series are exact to rounding.
_SMALL = 3e-3


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
def turned(X: Floats, i: int, c: float, s: float, out: Floats) -> None:
    """Fill in X Rot(z, theta) of joint i, by the cosine and the sine of theta; ``out`` may be X."""
    for row in range(3):
        x, y, z = X[i, row, 0], X[i, row, 1], X[i, row, 2]
        out[i, row, 0], out[i, row, 1], out[i, row, 2] = c * x + s * y, c * y - s * x, z


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
def unturned(R: Floats, before: Floats, i: int) -> None:
    """Fill in how link i is turned but for its own joint, R[i - 1] before[i]."""
    for row in range(3):
        for col in range(3):
            if i == 0:
                R[i, row, col] = before[i, row, col]
            else:
                R[i, row, col] = (
                    R[i - 1, row, 0] * before[i, 0, col]
                    + R[i - 1, row, 1] * before[i, 1, col]
                    + R[i - 1, row, 2] * before[i, 2, col]
                )


@inlined
def link_rotations(facing: Floats, before: Floats, R: Floats) -> None:
    """Fill in how every link is turned, R (n_joint, 3, 3), by the cosines and sines of how each one is."""
    for i in range(len(facing)):
        unturned(R, before, i)
        turned(R, i, facing[i, 0], facing[i, 1], R)


@inlined
def angles(state: Reckoning, before: Floats, pair: Floats, R: Floats, end: Floats, facing: Floats) -> None:
    """Find the joint variables from where the sensors have come to, link by link from the base.

    ``end`` (3,) has room for the far end of the link before.
    """
    geometry, q, moved, baseline = state.chain.geometry, state.q, state.moved, state.baseline
    for row in range(3):
        end[row] = 0.0
    for i in range(q.size):
        state.q_before[i] = q[i]
        a, d = geometry[i, 1], geometry[i, 2]
        one, two = state.pair[i, 0], state.pair[i, 1]
        unturned(R, before, i)
        if state.chain.revolute[i]:
            x = y = 0.0
            for row in range(3):
                u = baseline[i, row] + moved[two, row] - moved[one, row]
                x += R[i, row, 0] * u
                y += R[i, row, 1] * u
            length = math.sqrt(x * x + y * y)
            if length > 0.0:  # the angle that turns one pair onto the other
                c = (x * pair[i, 0] + y * pair[i, 1]) / length
                s = (y * pair[i, 0] - x * pair[i, 1]) / length
                was_c, was_s = facing[i, 0], facing[i, 1]
                q[i] += direction(was_c * c + was_s * s, was_c * s - was_s * c)  # by the nearest turn
                facing[i, 0], facing[i, 1] = c, s
            slid = d
        turned(R, i, facing[i, 0], facing[i, 1], R)
        if not state.chain.revolute[i]:
            z = 0.0
            for row in range(3):
                at = end[row] + d * R[i, row, 2]
                for col in range(3):
                    at += R[i, row, col] * state.position[one, col]
                z += R[i, row, 2] * (state.start[one, row] + moved[one, row] - at)
            q[i] = z
            slid = d + z
        for row in range(3):
            end[row] += slid * R[i, row, 2] + a * R[i, row, 0]
