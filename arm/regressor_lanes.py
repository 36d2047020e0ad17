"""The regressor's recursion for several samples side by side, which a processor's vector unit takes at once.

Arrays have their samples last, `LANES` of them. Every sample is computed as it would be alone: the order of
operations is that of `arm.newton_euler`, and the result the same to the last bit. All is compiled into its caller:
a compiler makes vectors only where it sees that arrays are not parts of one another.
"""

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.model import Floats
from arm.triple import Triple
from limbcal.compiled import inlined

#: Samples side by side: enough that a compiler makes vectors of them, and few enough to stay in a core's cache.
LANES = 16
#: What a joint's motion is in: cosine (of one that slides: the shift), sine, velocity, acceleration.
COSINE, SINE, VELOCITY, ACCELERATION = range(4)
N_STATE = 4


@inlined
def cross(a: Triple, b: Triple) -> Triple:
    """Return ``a x b``: as in `arm.triple`, but compiled into its caller."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def turned_back_lane(R: Floats, i: int, b: int, a: Triple) -> Triple:
    """Return ``R_i^T a`` for one sample."""
    return (
        R[i, 0, b] * a[0] + R[i, 3, b] * a[1] + R[i, 6, b] * a[2],
        R[i, 1, b] * a[0] + R[i, 4, b] * a[1] + R[i, 7, b] * a[2],
        R[i, 2, b] * a[0] + R[i, 5, b] * a[1] + R[i, 8, b] * a[2],
    )


@inlined
def begin_lanes(chain: Chain, R0: Floats, p0: Floats, R: Floats, p: Floats, motion: Floats, unit: Floats) -> None:
    """Fill in what all samples share: zero poses, each joint's own unit motion, the base's acceleration."""
    n = len(R0)
    for i in range(n):
        for row in range(3):
            p[i, row] = p0[i, row]
            for column in range(3):
                R[i, 3 * row + column] = R0[i, row, column]
        unit[i, i] = 0.0
        unit[i, i, 5 if chain.revolute[i] else 2] = 1.0
    motion[n] = 0.0
    for row in range(3):
        motion[n, 6 + row] = -chain.gravity[row]  # so that v_dot is the specific force


@inlined
def fill_lanes(
    revolute: NDArray[np.bool_],
    first: int,
    used: int,
    q: Floats,
    cosine: Floats,
    sine: Floats,
    dq: Floats,
    ddq: Floats,
    state: Floats,
) -> None:
    """Fill in how all joints move in some samples; lanes that are left over repeat the last of them."""
    for i in range(len(state)):
        for b in range(LANES):
            s = first + min(b, used - 1)
            state[i, COSINE, b] = cosine[s, i] if revolute[i] else q[s, i]
            state[i, SINE, b], state[i, VELOCITY, b], state[i, ACCELERATION, b] = sine[s, i], dq[s, i], ddq[s, i]


@inlined
def move_lanes(turns: bool, i: int, state: Floats, R0: Floats, p0: Floats, R: Floats, p: Floats) -> None:
    """Turn or slide joint i from the arm's zero pose.

    Parameters
    ----------
    turns : bool
    i : int
    state : (n_joint, 4, LANES)
    R0, p0 : (n_joint, 3, 3), (n_joint, 3)
        Zero pose of each joint-axis frame in its parent's.
    R, p : (n_joint, 9, LANES), (n_joint, 3, LANES)
        Poses, row by row; those of joint i are changed.
    """
    for row in range(3):
        x, y, z = R0[i, row, 0], R0[i, row, 1], R0[i, row, 2]
        if turns:
            for b in range(LANES):
                c, s = state[i, COSINE, b], state[i, SINE, b]
                R[i, 3 * row, b], R[i, 3 * row + 1, b] = c * x + s * y, c * y - s * x
        else:
            for b in range(LANES):
                p[i, row, b] = p0[i, row] + state[i, COSINE, b] * z


@inlined
def rigid_motion_lanes(turns: bool, i: int, on: int, state: Floats, R: Floats, p: Floats, motion: Floats) -> None:
    """Fill in omega, omega_dot and v_dot of joint-axis frame i, in itself.

    Parameters
    ----------
    turns : bool
    i, on : int
        Link, and that on which it hangs; the last of ``motion`` is the base.
    state, R, p
        As in `move_lanes`.
    motion : (n_joint + 1, 9, LANES)
    """
    for b in range(LANES):
        w = (motion[on, 0, b], motion[on, 1, b], motion[on, 2, b])
        dw = (motion[on, 3, b], motion[on, 4, b], motion[on, 5, b])
        dv = (motion[on, 6, b], motion[on, 7, b], motion[on, 8, b])
        to_axis = (p[i, 0, b], p[i, 1, b], p[i, 2, b])
        swing, pull = cross(dw, to_axis), cross(w, cross(w, to_axis))
        dv = turned_back_lane(
            R, i, b, (dv[0] + swing[0] + pull[0], dv[1] + swing[1] + pull[1], dv[2] + swing[2] + pull[2])
        )
        w, dw = turned_back_lane(R, i, b, w), turned_back_lane(R, i, b, dw)
        dq, ddq = state[i, VELOCITY, b], state[i, ACCELERATION, b]
        if turns:  # rho = 1
            dw = (dw[0] + w[1] * dq, dw[1] - w[0] * dq, dw[2] + ddq)  # (R omega) x z dq + z ddq
            w = (w[0], w[1], w[2] + dq)
        else:
            dv = (dv[0] + 2.0 * w[1] * dq, dv[1] - 2.0 * w[0] * dq, dv[2] + ddq)  # 2 omega x z dq
        motion[i, 0, b], motion[i, 1, b], motion[i, 2, b] = w
        motion[i, 3, b], motion[i, 4, b], motion[i, 5, b] = dw
        motion[i, 6, b], motion[i, 7, b], motion[i, 8, b] = dv


@inlined
def carry_lanes(i: int, on: int, joint: int, R: Floats, p: Floats, unit: Floats, carried: Floats) -> None:
    """Carry the motion that a joint alone makes from a link to the next.

    Parameters
    ----------
    i, on, joint : int
        Link, that on which it hangs, and the joint that moves at unit speed.
    R, p
        As in `move_lanes`.
    unit : (n_joint, n_joint, 6, LANES)
        Velocity and angular velocity of each link for each joint on its way to the base, in the link.
    carried : (6, LANES)
        Link i's: apart, so that a compiler sees that it is no part of what it is made of.
    """
    for b in range(LANES):
        about = (unit[on, joint, 3, b], unit[on, joint, 4, b], unit[on, joint, 5, b])
        x = cross(about, (p[i, 0, b], p[i, 1, b], p[i, 2, b]))
        along = (unit[on, joint, 0, b] + x[0], unit[on, joint, 1, b] + x[1], unit[on, joint, 2, b] + x[2])
        carried[0, b], carried[1, b], carried[2, b] = turned_back_lane(R, i, b, along)
        carried[3, b], carried[4, b], carried[5, b] = turned_back_lane(R, i, b, about)
    for k in range(6):
        for b in range(LANES):
            unit[i, joint, k, b] = carried[k, b]


@inlined
def link_powers_lanes(i: int, joint: int, motion: Floats, unit: Floats, out: Floats) -> None:
    """Fill in the power of a link's wrench in a unit motion, for its ten parameters: out (10, LANES).

    The link moves with w, dw, dv, and the unit motion has the velocity ``along`` at the link's origin and the
    angular velocity ``about``. With f = m dv + dw x s + w x (w x s) and n = I dw + w x I w + s x dv (section 4;
    s is the first moment) the power is along . f + about . n.
    """
    for b in range(LANES):
        w = (motion[i, 0, b], motion[i, 1, b], motion[i, 2, b])
        dw = (motion[i, 3, b], motion[i, 4, b], motion[i, 5, b])
        dv = (motion[i, 6, b], motion[i, 7, b], motion[i, 8, b])
        along = (unit[i, joint, 0, b], unit[i, joint, 1, b], unit[i, joint, 2, b])
        about = (unit[i, joint, 3, b], unit[i, joint, 4, b], unit[i, joint, 5, b])
        gyro = cross(about, w)  # about . (w x I w) = (about x w) . I w
        out[0, b] = about[0] * dw[0] + gyro[0] * w[0]
        out[1, b] = about[1] * dw[1] + gyro[1] * w[1]
        out[2, b] = about[2] * dw[2] + gyro[2] * w[2]
        out[3, b] = about[0] * dw[1] + about[1] * dw[0] + gyro[0] * w[1] + gyro[1] * w[0]
        out[4, b] = about[0] * dw[2] + about[2] * dw[0] + gyro[0] * w[2] + gyro[2] * w[0]
        out[5, b] = about[1] * dw[2] + about[2] * dw[1] + gyro[1] * w[2] + gyro[2] * w[1]
        lever, swing, pull = cross(dv, about), cross(along, dw), cross(w, cross(w, along))
        out[6, b] = lever[0] + swing[0] + pull[0]
        out[7, b] = lever[1] + swing[1] + pull[1]
        out[8, b] = lever[2] + swing[2] + pull[2]
        out[9, b] = along[0] * dv[0] + along[1] * dv[1] + along[2] * dv[2]
