"""The equations of motion as `arm.integration` solves them, step by step and without making arrays."""

from typing import NamedTuple

import numpy as np

from arm.chain import Chain
from arm.model import Floats
from arm.newton_euler import mass_columns, poses, rigid_motion, rigid_torque
from limbcal.compiled import compiled


class Room(NamedTuple):
    """Arrays to work in, made once a simulation."""

    R: Floats
    p: Floats
    motion: Floats
    zero: Floats
    A: Floats
    M: Floats
    net: Floats
    bias: Floats
    now: Floats


@compiled
def make_room(n: int) -> Room:
    """Return the working arrays for ``n`` joints."""
    return Room(
        np.empty((n, 3, 3)),
        np.empty((n, 3)),
        np.empty((n, 3, 3)),
        np.zeros(n + 6),
        np.empty((n, n)),
        np.empty((n, n)),
        np.empty(n),
        np.empty(n),
        np.empty(n),
    )


@compiled
def solve(A: Floats, x: Floats) -> None:
    """Turn ``x`` into ``A^-1 x`` by elimination with partial pivoting; ``A`` is used up."""
    n = x.size
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        if pivot != k:
            x[k], x[pivot] = x[pivot], x[k]
            for j in range(k, n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            x[i] -= factor * x[k]
            for j in range(k + 1, n):
                A[i, j] -= factor * A[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            x[k] -= A[k, j] * x[j]
        x[k] /= A[k, k]


@compiled
def equations(chain: Chain, law: Floats, given: bool, q: Floats, dq: Floats, drive: Floats, room: Room) -> None:
    """Set up ``M ddq = net``: the law's share of ddq is on the left, Coulomb friction is not in it."""
    n = q.size
    poses(chain, q, room.R, room.p)
    mass_columns(chain, room.R, room.p, room.motion, room.zero, room.M)
    rigid_motion(chain, chain.gravity, room.R, room.p, dq, room.zero[:n], room.motion)
    rigid_torque(chain, room.R, room.p, room.motion, room.zero[-6:], room.bias)
    for i in range(n):
        tau = drive[i] if given else law[0, i] * (drive[i] - q[i]) + law[1, i] * dq[i]  # eq. (5), (7)
        room.net[i] = tau - room.bias[i] - chain.friction[i, 0] * dq[i]
        room.M[i, i] -= law[2, i]  # eq. (6): ka ddq belongs with M ddq


@compiled
def acceleration(chain: Chain, mode: Floats, room: Room, ddq: Floats) -> None:
    """Solve the equations with every joint in its mode; a stuck joint does not accelerate."""
    for i in range(ddq.size):
        if mode[i] == 0.0:
            room.A[i] = 0.0
            room.A[i, i] = 1.0
            ddq[i] = 0.0
        else:
            room.A[i] = room.M[i]
            ddq[i] = room.net[i] - chain.friction[i, 1] * mode[i]
    solve(room.A, ddq)
    for i in range(ddq.size):
        if mode[i] == 0.0:
            ddq[i] = 0.0  # to the last bit: pivoting may have left rounding there
