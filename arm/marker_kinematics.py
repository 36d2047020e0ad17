"""Where optical markers are on a tree whose base moves, and how that changes with every number: kernels.

A marker's place is given in its link's joint-axis frame. Of a tree with frames ``R_i, o_i`` it is
``y = o_l + R_l x``; a turn about an axis ``z`` through ``o`` moves it by ``z × (y - o)``, a shift by the shift
itself, whatever joint or number of eq. (1) turns or shifts (the columns of a geometric Jacobian). Only what is on
the way from the base to the marker's link moves it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import hang_on, link_step
from arm.model import Floats
from limbcal.compiled import compiled

Integers = NDArray[np.int64]

#: What a free number of the geometry is: one of eq. (1), by its column of `Chain.geometry`, one of frame 0's pose
#: in the segment that carries it, or where a joint hangs on its parent, along one of the parent's axes.
ALPHA, A, D, BETA = range(4)
BASE_POSITION, BASE_ROTATION = 5, 6
HANG_X, HANG_Y, HANG_Z = range(7, 10)


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
    parent : (n,) int64
    hang : (n, 4)
        As `arm.chain.Chain` has them.
    moves : (n, n) bool
        Whether link i moves with joint j, see `moved_by`.
    depth, way : (n,) and (n, n) int64
        How many joints move link i, and which, from the base on, in the first columns; see `ways`.
    zero_R, zero_p : (n, 3, 3), (n, 3) [m]
        Eq. (1) of each joint at zero, from where it hangs on its parent: what of it does not change.
    hung : (n, 3) [m]
        Where that is, in the parent's joint-axis frame.
    """

    revolute: NDArray[np.bool_]
    geometry: Floats
    link: Integers
    place: Floats
    base_R: Floats
    base_p: Floats
    parent: Integers
    hang: Floats
    moves: NDArray[np.bool_]
    depth: Integers
    way: Integers
    zero_R: Floats
    zero_p: Floats
    hung: Floats


def marker_chain(
    revolute: NDArray[np.bool_],
    geometry: Floats,
    link: Integers,
    place: Floats,
    base_R: Floats,
    base_p: Floats,
    parent: Integers,
    hang: Floats,
) -> MarkerChain:
    """Return the chain of these numbers, see `MarkerChain`."""
    moves, n = moved_by(parent), len(parent)
    zero_R, zero_p, hung = np.empty((n, 3, 3)), np.empty((n, 3)), np.zeros((n, 3))
    _zero_poses(geometry, parent, hang, zero_R, zero_p, hung)
    return MarkerChain(
        revolute, geometry, link, place, base_R, base_p, parent, hang, moves, *ways(moves), zero_R, zero_p, hung
    )


@compiled
def _zero_poses(
    geometry: Floats, parent: Integers, hang: Floats, zero_R: Floats, zero_p: Floats, hung: Floats
) -> None:
    for i in range(parent.size):
        alpha, _, d, beta, offset = geometry[i]
        link_step(True, alpha, d, beta, offset, 0.0, zero_R[i], zero_p[i])
        hang_on(geometry, parent, hang, i, hung[i])


def moved_by(parent: Integers) -> NDArray[np.bool_]:
    """Return whether link i moves with joint j, which is so where j is on its way to the base, (n, n)."""
    moves = np.eye(len(parent), dtype=np.bool_)
    for i, before in enumerate(parent.tolist()):
        if before >= 0:
            moves[i] |= moves[before]
    return moves


def ways(moves: NDArray[np.bool_]) -> tuple[Integers, Integers]:
    """Return how many joints move each link, (n,), and which these are, in the first columns of (n, n)."""
    depth = moves.sum(axis=1)
    way = np.argsort(~moves, axis=1, kind="stable")
    return depth.astype(np.int64), way.astype(np.int64)


class Slopes(NamedTuple):
    """Room for one frame: link frames in the world, and slopes of one marker's place.

    Attributes
    ----------
    R : (n, 3, 3)
    o : (n, 3)
    before : (n + 1, 3, 3)
        The axes of each joint's parent in the world, and those of frame 0.
    far : (n + 1, 3)
        Where each joint hangs on its parent, and the origin of frame 0.
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
    n, R, o, before, far, Z = q.size, room.R, room.o, room.before, room.far, chain.zero_R
    for row in range(3):
        far[n, row] = p_base[row]
        for col in range(3):
            far[n, row] += R_base[row, col] * chain.base_p[col]
            before[n, row, col] = (
                R_base[row, 0] * chain.base_R[0, col]
                + R_base[row, 1] * chain.base_R[1, col]
                + R_base[row, 2] * chain.base_R[2, col]
            )
    for i in range(n):
        parent, turns = chain.parent[i], chain.revolute[i]
        c, s, slid = 1.0, 0.0, 0.0
        if turns:
            c, s = math.cos(q[i]), math.sin(q[i])
        else:
            slid = q[i]
        for row in range(3):
            if parent >= 0:
                b0, b1, b2, at = R[parent, row, 0], R[parent, row, 1], R[parent, row, 2], o[parent, row]
            else:
                b0, b1, b2, at = before[n, row, 0], before[n, row, 1], before[n, row, 2], far[n, row]
            before[i, row, 0], before[i, row, 1], before[i, row, 2] = b0, b1, b2
            at += b0 * chain.hung[i, 0] + b1 * chain.hung[i, 1] + b2 * chain.hung[i, 2]
            far[i, row] = at
            x = b0 * Z[i, 0, 0] + b1 * Z[i, 1, 0] + b2 * Z[i, 2, 0]
            y = b0 * Z[i, 0, 1] + b1 * Z[i, 1, 1] + b2 * Z[i, 2, 1]
            z = b0 * Z[i, 0, 2] + b1 * Z[i, 1, 2] + b2 * Z[i, 2, 2]
            at += b0 * chain.zero_p[i, 0] + b1 * chain.zero_p[i, 1] + b2 * chain.zero_p[i, 2]
            o[i, row] = at + slid * z
            R[i, row, 0], R[i, row, 1], R[i, row, 2] = c * x + s * y, c * y - s * x, z


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
    room.by_q[:] = 0.0
    for k in range(chain.depth[link]):
        i = chain.way[link, k]
        if chain.revolute[i]:
            _turn(room.R[i, :, 2], room.o[i], y, room.by_q, i)
        else:
            for row in range(3):
                room.by_q[row, i] = room.R[i, row, 2]


@compiled
def free_slopes(chain: MarkerChain, room: Slopes, R_base: Floats, free: Integers, m: int, y: Floats) -> None:
    """Fill in ``room.by_free``: how a marker at ``y`` moves with the free numbers of the geometry.

    ``free`` (n_free, 2) holds what each is, such as `ALPHA`, and of which joint (or along which axis), from 0.
    """
    link, n, axis = chain.link[m], chain.geometry.shape[0], np.empty(3)
    for j in range(free.shape[0]):
        kind, i = free[j, 0], free[j, 1]
        room.by_free[:, j] = 0.0
        if kind == BASE_POSITION:
            room.by_free[:, j] = R_base[:, i]
        elif kind == BASE_ROTATION:
            _turn(room.before[n, :, i], room.far[n], y, room.by_free, j)
        elif kind == A:
            if chain.moves[link, i] and link != i:
                room.by_free[:, j] = _reach(chain, link, i) * room.R[i, :, 0]
        elif chain.moves[link, i]:
            if kind >= HANG_X:
                room.by_free[:, j] = room.before[i, :, kind - HANG_X]
            elif kind == D:
                room.by_free[:, j] = room.R[i, :, 2]
            elif kind == BETA:  # about y of the frame before, eq. (1)
                _turn(room.before[i, :, 1], room.far[i], y, room.by_free, j)
            else:  # alpha, about x of the frame before turned by beta
                c, s = np.cos(chain.geometry[i, BETA]), np.sin(chain.geometry[i, BETA])
                for row in range(3):
                    axis[row] = c * room.before[i, row, 0] - s * room.before[i, row, 2]
                _turn(axis, room.far[i], y, room.by_free, j)


@compiled
def _reach(chain: MarkerChain, link: int, i: int) -> float:
    """Return the share of link i's a at which the way to a link that hangs on it goes on."""
    while chain.parent[link] != i:
        link = chain.parent[link]
    return float(chain.hang[link, 0])
