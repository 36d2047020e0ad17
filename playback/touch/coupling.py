"""The virtual coupling: spring and damper between the hand and the touched point, and the wall, compiled.

The spring is conservative and gives way at its limit: its energy is ``K r^2 / 2`` up to there and grows linearly
beyond. So its force is the gradient of a convex energy whose slope changes by at most K a metre, which is what
the proof of passivity needs (docs/coupling.md). The damper is cut, never reversed, where both together would
exceed the limit.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.model import Floats
from arm.outer_wrench import add_outer_torque, point_motion
from arm.triple import Triple, turned_back
from limbcal.compiled import compiled, inlined
from playback.touch.rotation import turned_between, turned_on

#: What `Touch.numbers` has: of the coupling's translation and rotation, of the wall, of the device.
(
    STIFFNESS, DAMPING, LIMIT,
    TURN_STIFFNESS, TURN_DAMPING, TURN_LIMIT,
    WALL_STIFFNESS, WALL_LIMIT,
    DEVICE, TURN_DEVICE, INTERVAL,
) = range(11)  # fmt: skip
N_NUMBER = 11
#: What `Touch.account` has [J]: work that the hand did, work that the arm got, what changed stiffness brought in,
#: what the device's own damping took at least, what is stored; and in how many ticks it did not add up.
HAND, ARM, INJECTED, CREDIT, STORED, BRAKED = range(6)
N_ACCOUNT = 6


class Touch(NamedTuple):
    """The hand, the point it holds and what passes between them; all in the base frame unless said otherwise.

    Attributes
    ----------
    joint : (1,) int
        The touched link, from 0; -1 where nobody holds the arm.
    point : (3,)
        In the link's joint-axis frame.
    path : (2, 3)
        Where the hand was at the last tick and where it is at this one; in between it moves straight.
    seen : (2, 3)
        The hand's velocity and angular velocity as they are known at this tick.
    frame : (3, 3)
        The hand's orientation at the last tick, as that of the link it would hold without a twist.
    twist : (3,)
        By which rotation vector the hand has turned since.
    span : (3,)
        The step of this tick, of how many, and its seconds.
    wall : (4,)
        Unit normal n and offset c: the hand is free where ``n.x >= c``.
    numbers : (11,)
    felt, sent : (2, 3)
        Force and moment on the hand at the end of the tick, and those that were last sent to it.
    axes, moving : (3, 3)
        The link's axes as columns; the point's place and velocity and the link's angular velocity.
    account : (6,)
    room : (2, 3, 3)
        To work in.
    """

    joint: NDArray[np.int64]
    point: Floats
    path: Floats
    seen: Floats
    frame: Floats
    twist: Floats
    span: Floats
    wall: Floats
    numbers: Floats
    felt: Floats
    sent: Floats
    axes: Floats
    moving: Floats
    account: Floats
    room: Floats


@compiled
def length(a: Triple) -> float:
    """Return ``|a|``."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@compiled
def spring_energy(stiffness: float, limit: float, stretch: float) -> float:
    """Return what a spring that gives way at ``limit`` stores at a stretch [J]."""
    if stiffness * stretch <= limit:
        return stiffness * stretch * stretch / 2.0
    return limit * (stretch - limit / stiffness / 2.0)


@compiled
def spring_and_damper(stiffness: float, damping: float, limit: float, e: Triple, de: Triple) -> Triple:
    """Return the pull of a stretch ``e`` that grows by ``de`` a second; it is at most ``limit``."""
    stretch = length(e)
    k = stiffness if stiffness * stretch <= limit else limit / stretch
    s = (k * e[0], k * e[1], k * e[2])
    d = (damping * de[0], damping * de[1], damping * de[2])
    both = (s[0] + d[0], s[1] + d[1], s[2] + d[2])
    if length(both) <= limit:
        return both
    sd = s[0] * d[0] + s[1] * d[1] + s[2] * d[2]
    dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    left = max(limit * limit - (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]), 0.0)
    root = math.sqrt(sd * sd + dd * left)  # |s + share d| is the limit; whichever form has no difference of equals
    share = 0.0
    if sd > 0.0:
        share = left / (root + sd)
    elif dd > 0.0:
        share = (root - sd) / dd
    share = min(share, 1.0)
    return s[0] + share * d[0], s[1] + share * d[1], s[2] + share * d[2]


@compiled
def stretch_at(touch: Touch, part: float) -> tuple[Triple, Triple]:
    """Return how far, and by which rotation vector, the hand is ahead of the arm at a part of this tick."""
    a, b, at = touch.path[0], touch.path[1], touch.moving[0]
    ahead = (
        a[0] + part * (b[0] - a[0]) - at[0],
        a[1] + part * (b[1] - a[1]) - at[1],
        a[2] + part * (b[2] - a[2]) - at[2],
    )
    if touch.numbers[TURN_STIFFNESS] == 0.0 and touch.numbers[TURN_DAMPING] == 0.0:
        return ahead, (0.0, 0.0, 0.0)
    turned_on(touch.frame, touch.twist, part, touch.room[0], touch.room[1])
    return ahead, turned_between(touch.room[1], touch.axes, touch.room[0])


@compiled
def pull(
    touch: Touch, part: float, vx: float, vy: float, vz: float, wx: float, wy: float, wz: float
) -> tuple[Triple, Triple]:
    """Return force and moment of the coupling on the arm, the hand moving with the given velocities."""
    e, turn = stretch_at(touch, part)
    v, w, x = touch.moving[1], touch.moving[2], touch.numbers
    f = spring_and_damper(x[STIFFNESS], x[DAMPING], x[LIMIT], e, (vx - v[0], vy - v[1], vz - v[2]))
    dw = (wx - w[0], wy - w[1], wz - w[2])
    return f, spring_and_damper(x[TURN_STIFFNESS], x[TURN_DAMPING], x[TURN_LIMIT], turn, dw)


@inlined
def couple(chain: Chain, touch: Touch, R: Floats, p: Floats, dq: Floats, share: float, net: Floats) -> float:
    """Add to ``net`` what the hand does at the joints, a share of a step on; return its power on the arm [W]."""
    joint = touch.joint[0]
    if joint < 0:
        return 0.0
    point_motion(chain, R, p, dq, joint, touch.point, touch.axes, touch.moving)
    step, n, h = touch.span[0], touch.span[1], touch.span[1] * touch.span[2]
    a, b, d = touch.path[0], touch.path[1], touch.twist
    f, m = pull(
        touch,
        (step + share) / n,
        *((b[0] - a[0]) / h, (b[1] - a[1]) / h, (b[2] - a[2]) / h),
        *(d[0] / h, d[1] / h, d[2] / h),
    )
    add_outer_torque(chain, R, p, joint, touch.point, turned_back(touch.axes, f), turned_back(touch.axes, m), net)
    v, w = touch.moving[1], touch.moving[2]
    return float(f[0] * v[0] + f[1] * v[1] + f[2] * v[2] + m[0] * w[0] + m[1] * w[1] + m[2] * w[2])


@compiled
def stored(touch: Touch, part: float) -> float:
    """Return what coupling and wall store, the hand being at its last (0) or its present place (1) [J]."""
    if touch.joint[0] < 0:
        return 0.0
    e, turn = stretch_at(touch, part)
    x = touch.numbers
    energy = spring_energy(x[STIFFNESS], x[LIMIT], length(e))
    energy += spring_energy(x[TURN_STIFFNESS], x[TURN_LIMIT], length(turn))
    return energy + spring_energy(x[WALL_STIFFNESS], x[WALL_LIMIT], depth(touch, part))


@compiled
def depth(touch: Touch, part: float) -> float:
    """Return how deep the hand is in the wall, at its last (0) or its present place (1) [m]."""
    n = touch.wall
    inside = n[3]
    for row in range(3):
        inside -= n[row] * (touch.path[0, row] + part * (touch.path[1, row] - touch.path[0, row]))
    return float(max(inside, 0.0))
