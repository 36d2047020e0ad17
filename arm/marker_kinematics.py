"""Where optical markers are on a chain whose base moves, and how that changes with every number: kernels.

A marker's place is given in its link's joint-axis frame. Of a chain with frames ``R_i, o_i`` it is
``y = o_l + R_l x``; a turn about an axis ``z`` through ``o`` moves it by ``z × (y - o)``, a shift by the shift
itself, whatever joint or number of eq. (1) turns or shifts (the columns of a geometric Jacobian).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import link_step
from arm.model import Floats
from limbcal.compiled import compiled

Integers = NDArray[np.int64]

#: What a free number of the geometry is: one of eq. (1), by its column of `Chain.geometry`, or of frame 0's pose
#: in the segment that carries it.
ALPHA, A, D, BETA = range(4)
BASE_POSITION, BASE_ROTATION = 5, 6


class MarkerChain(NamedTuple):
    """The numbers of an arm with markers, as kernels take them.

    Attributes
    ----------
    revolute : (n,) bool
    geometry : (n, 5)
        alpha, a, d, beta, theta offset of each joint.
    link : (m,) int64
        Which link a marker rides on, from 0.
    place : (m, 3) [m]
        In the link's joint-axis frame.
    base_R : (3, 3)
        Frame 0's axes as columns, in the segment that carries it.
    base_p : (3,) [m]
        Frame 0's origin there.
    """

    revolute: NDArray[np.bool_]
    geometry: Floats
    link: Integers
    place: Floats
    base_R: Floats
    base_p: Floats


class Slopes(NamedTuple):
    """Room for one frame: link frames in the world, and slopes of one marker's place.

    Attributes
    ----------
    R : (n, 3, 3)
    o : (n, 3)
    before : (n + 1, 3, 3)
        Frame i's axes in the world before joint i + 1; the last is not used.
    far : (n + 1, 3)
        Its origin, the far end of the link before.
    by_q : (3, n)
    by_free : (3, n_free)
    """

    R: Floats
    o: Floats
    before: Floats
    far: Floats
    by_q: Floats
    by_free: Floats


def slopes_room(n_joint: int, n_free: int) -> Slopes:
    """Return room for one frame."""
    return Slopes(
        np.empty((n_joint, 3, 3)),
        np.empty((n_joint, 3)),
        np.empty((n_joint + 1, 3, 3)),
        np.empty((n_joint + 1, 3)),
        np.zeros((3, n_joint)),
        np.zeros((3, n_free)),
    )


@compiled
def link_frames(chain: MarkerChain, R_base: Floats, p_base: Floats, q: Floats, room: Slopes) -> None:
    """Fill in the world poses of all joint-axis frames for one frame of the base segment's pose."""
    r, p = np.empty((3, 3)), np.empty(3)
    for row in range(3):
        room.far[0, row] = p_base[row]
        for col in range(3):
            room.far[0, row] += R_base[row, col] * chain.base_p[col]
            room.before[0, row, col] = (
                R_base[row, 0] * chain.base_R[0, col]
                + R_base[row, 1] * chain.base_R[1, col]
                + R_base[row, 2] * chain.base_R[2, col]
            )
    for i in range(q.size):
        alpha, a, d, beta, offset = chain.geometry[i]
        link_step(chain.revolute[i], alpha, d, beta, offset, q[i], r, p)
        now, at, B = room.R[i], room.o[i], room.before[i]
        for row in range(3):
            at[row] = room.far[i, row] + B[row, 0] * p[0] + B[row, 1] * p[1] + B[row, 2] * p[2]
            for col in range(3):
                now[row, col] = B[row, 0] * r[0, col] + B[row, 1] * r[1, col] + B[row, 2] * r[2, col]
        for row in range(3):
            room.far[i + 1, row] = at[row] + a * now[row, 0]
            for col in range(3):
                room.before[i + 1, row, col] = now[row, col]


@compiled
def marker_at(chain: MarkerChain, room: Slopes, m: int, y: Floats) -> None:
    """Fill in where marker ``m`` is, given the link frames."""
    link = chain.link[m]
    for row in range(3):
        y[row] = room.o[link, row]
        for col in range(3):
            y[row] += room.R[link, row, col] * chain.place[m, col]


@compiled
def _turn(z: Floats, o: Floats, y: Floats, out: Floats, column: int) -> None:
    """Fill in a column of slopes: ``z × (y - o)``."""
    x0, x1, x2 = y[0] - o[0], y[1] - o[1], y[2] - o[2]
    out[0, column] = z[1] * x2 - z[2] * x1
    out[1, column] = z[2] * x0 - z[0] * x2
    out[2, column] = z[0] * x1 - z[1] * x0


@compiled
def joint_slopes(chain: MarkerChain, room: Slopes, m: int, y: Floats) -> None:
    """Fill in ``room.by_q``: how a marker at ``y`` moves with every joint's variable."""
    link = chain.link[m]
    for i in range(chain.geometry.shape[0]):
        if i > link:
            room.by_q[:, i] = 0.0
        elif chain.revolute[i]:
            _turn(room.R[i, :, 2], room.o[i], y, room.by_q, i)
        else:
            room.by_q[:, i] = room.R[i, :, 2]


@compiled
def free_slopes(chain: MarkerChain, room: Slopes, R_base: Floats, free: Integers, m: int, y: Floats) -> None:
    """Fill in ``room.by_free``: how a marker at ``y`` moves with the free numbers of the geometry.

    ``free`` (n_free, 2) holds what each is, such as `ALPHA`, and of which joint (or along which axis), from 0.
    """
    link = chain.link[m]
    axis = np.empty(3)
    for j in range(free.shape[0]):
        kind, i = free[j, 0], free[j, 1]
        room.by_free[:, j] = 0.0
        if kind == BASE_POSITION:
            room.by_free[:, j] = R_base[:, i]
        elif kind == BASE_ROTATION:
            _turn(room.before[0, :, i], room.far[0], y, room.by_free, j)
        elif kind == A:
            if link > i:
                room.by_free[:, j] = room.R[i, :, 0]
        elif link >= i:
            if kind == D:
                room.by_free[:, j] = room.R[i, :, 2]
            elif kind == BETA:  # about y of the frame before, eq. (1)
                _turn(room.before[i, :, 1], room.far[i], y, room.by_free, j)
            else:  # alpha, about x of the frame before turned by beta
                c, s = np.cos(chain.geometry[i, BETA]), np.sin(chain.geometry[i, BETA])
                for row in range(3):
                    axis[row] = c * room.before[i, row, 0] - s * room.before[i, row, 2]
                _turn(axis, room.far[i], y, room.by_free, j)
