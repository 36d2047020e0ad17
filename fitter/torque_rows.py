"""The rows of the torque regressor and the sums of their products, a million samples in a fifth of a second.

It gives the numbers of `arm.regressor` by another road. A torque about joint j is the power that a link's
force and moment would have if joint j alone moved at unit speed. That unit motion is carried outwards from
link to link, six numbers a joint, where the regressor carries ten columns of wrenches inwards; and poses are
turned from the arm's zero pose, so the constant angles of eq. (1) are evaluated once.
"""

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.model import Floats
from arm.newton_euler import Triple, cross, poses, rigid_motion, turned_back
from limbcal.compiled import compiled

#: Samples whose rows are made at a time; they stay in the processor's cache until they are summed.
_CHUNK = 64


@compiled
def torque_rows(chain: Chain, q: Floats, dq: Floats, ddq: Floats, Y: Floats) -> None:
    """Fill in the rows of some samples: Y (n_sample, n_joint, 12 * n_joint), which must begin as zeros."""
    n_sample, n = q.shape
    R0, p0 = np.empty((n, 3, 3)), np.empty((n, 3))
    poses(chain, np.zeros(n), R0, p0)
    R, p, motion, unit = R0.copy(), p0.copy(), np.empty((n, 3, 3)), np.empty((n, 6))
    for s in range(n_sample):
        move(chain.revolute, q[s], R0, p0, R, p)
        rigid_motion(chain, chain.gravity, R, p, dq[s], ddq[s], motion)
        for link in range(n):
            w = (motion[link, 0, 0], motion[link, 0, 1], motion[link, 0, 2])
            dw = (motion[link, 1, 0], motion[link, 1, 1], motion[link, 1, 2])
            dv = (motion[link, 2, 0], motion[link, 2, 1], motion[link, 2, 2])
            at, turns = (p[link, 0], p[link, 1], p[link, 2]), 1.0 if chain.revolute[link] else 0.0
            for joint in range(link + 1):
                along, about = (0.0, 0.0, 1.0 - turns), (0.0, 0.0, turns)
                if joint < link:  # from the link before, moved by this joint alone
                    along = (unit[joint, 0], unit[joint, 1], unit[joint, 2])
                    about = (unit[joint, 3], unit[joint, 4], unit[joint, 5])
                    x = cross(about, at)
                    along = turned_back(R[link], (along[0] + x[0], along[1] + x[1], along[2] + x[2]))
                    about = turned_back(R[link], about)
                for k in range(3):
                    unit[joint, k], unit[joint, 3 + k] = along[k], about[k]
                link_powers(w, dw, dv, along, about, Y[s, joint], 10 * link)
        for joint in range(n):
            Y[s, joint, 10 * n + joint] = dq[s, joint]
            Y[s, joint, 11 * n + joint] = np.sign(dq[s, joint])


@compiled
def move(revolute: NDArray[np.bool_], q: Floats, R0: Floats, p0: Floats, R: Floats, p: Floats) -> None:
    """Turn or slide every joint from the arm's zero pose to q."""
    for i in range(q.size):
        if revolute[i]:
            c, s = np.cos(q[i]), np.sin(q[i])
            for row in range(3):
                x, y = R0[i, row, 0], R0[i, row, 1]
                R[i, row, 0], R[i, row, 1] = c * x + s * y, c * y - s * x
        else:
            for row in range(3):
                p[i, row] = p0[i, row] + q[i] * R0[i, row, 2]


@compiled
def link_powers(w: Triple, dw: Triple, dv: Triple, along: Triple, about: Triple, out: Floats, at: int) -> None:
    """Fill in, from ``at`` on, the power of a link's wrench in a unit motion, for its ten parameters.

    The link moves with ``w, dw, dv`` and the unit motion has the velocity ``along`` at the link's origin and
    the angular velocity ``about``. With f = m dv + dw x s + w x (w x s) and
    n = I dw + w x I w + s x dv (section 4; s is the first moment) the power is along . f + about . n.
    """
    gyro = cross(about, w)  # about . (w x I w) = (about x w) . I w
    out[at] = about[0] * dw[0] + gyro[0] * w[0]
    out[at + 1] = about[1] * dw[1] + gyro[1] * w[1]
    out[at + 2] = about[2] * dw[2] + gyro[2] * w[2]
    out[at + 3] = about[0] * dw[1] + about[1] * dw[0] + gyro[0] * w[1] + gyro[1] * w[0]
    out[at + 4] = about[0] * dw[2] + about[2] * dw[0] + gyro[0] * w[2] + gyro[2] * w[0]
    out[at + 5] = about[1] * dw[2] + about[2] * dw[1] + gyro[1] * w[2] + gyro[2] * w[1]
    lever, swing, pull = cross(dv, about), cross(along, dw), cross(w, cross(w, along))
    for k in range(3):
        out[at + 6 + k] = lever[k] + swing[k] + pull[k]
    out[at + 9] = along[0] * dv[0] + along[1] * dv[1] + along[2] * dv[2]


@compiled
def add_rows(
    chain: Chain,
    columns: NDArray[np.intp],
    ends: NDArray[np.intp],
    q: Floats,
    dq: Floats,
    ddq: Floats,
    tau: Floats,
    rest_speed: float,
    gram: Floats,
    moment: Floats,
    power: Floats,
    row: Floats,
    torque: Floats,
    count: Floats,
) -> None:
    """Add every sample to the sums of its block; blocks lie between ``ends``."""
    n = q.shape[1]
    Y, w = np.zeros((_CHUNK, n, 12 * n)), np.empty(columns.size)
    for block in range(ends.size - 1):
        G, m, r, t = gram[block], moment[block], row[block], torque[block]
        for start in range(ends[block], ends[block + 1], _CHUNK):
            stop = min(start + _CHUNK, ends[block + 1])
            torque_rows(chain, q[start:stop], dq[start:stop], ddq[start:stop], Y)
            for k in range(start, stop):
                for joint in range(n):
                    if abs(dq[k, joint]) <= rest_speed:
                        continue
                    now = tau[k, joint]
                    power[block, joint] += now * now
                    count[block, joint] += 1.0
                    t[joint] += now
                    for a in range(columns.size):
                        w[a] = Y[k - start, joint, columns[a]]
                        if w[a] != 0.0:  # a joint does not feel the links before it: half of W is zeros
                            m[joint, a] += w[a] * now
                            r[joint, a] += w[a]
                            for b in range(a + 1):
                                G[joint, a, b] += w[a] * w[b]
        for joint in range(n):
            for a in range(columns.size):
                for b in range(a):
                    G[joint, b, a] = G[joint, a, b]
