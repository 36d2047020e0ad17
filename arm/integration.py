"""The compiled steps of `arm.simulation`.

``law`` (3, n_joint) holds kp, kv, ka. ``drive`` (n_sample, n_joint) is the target where the law is known and
the torque where it is measured. ``state`` (2, n_joint) is q, dq. ``motion`` (4, n_sample, n_joint) takes
q, dq, ddq, tau.
"""

from typing import NamedTuple

import numpy as np

from arm.chain import Chain
from arm.model import Floats
from arm.newton_euler import mass_columns, poses, rigid_motion, rigid_torque
from limbcal.compiled import compiled

#: How often one step may be cut by joints that come to rest.
_CUTS = 16


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


@compiled
def choose_modes(chain: Chain, dq: Floats, mode: Floats, room: Room, ddq: Floats) -> None:
    """Say which resting joints stick: those whose friction can hold them. The equations must be set up."""
    n = dq.size
    resting = False
    for i in range(n):
        if dq[i] != 0.0:
            mode[i] = np.sign(dq[i])
        elif chain.friction[i, 1] == 0.0 and chain.friction[i, 2] <= 0.0:
            mode[i] = 1.0  # nothing to hold it, and nothing that changes with its direction
        else:
            mode[i] = 0.0
            resting = True
    while resting:
        acceleration(chain, mode, room, ddq)
        worst, worst_joint, direction = 0.0, -1, 0.0
        for i in range(n):
            if mode[i] == 0.0:
                pull = room.net[i]
                for j in range(n):
                    pull -= room.M[i, j] * ddq[j]
                excess = abs(pull) - max(chain.friction[i, 2], chain.friction[i, 1], 0.0)
                if excess > worst:
                    worst, worst_joint, direction = excess, i, np.sign(pull)
        if worst_joint < 0:
            return
        mode[worst_joint] = direction  # the one that friction holds least goes first: it may relieve others


@compiled
def drive_at(drive: Floats, k: int, share: float, given: bool, out: Floats) -> None:
    """Fill in target (held) or torque (linear) at a share of the step after sample ``k``."""
    last = drive.shape[0] - 1
    for i in range(out.size):
        out[i] = drive[k, i]
        if given and k < last:
            out[i] += share * (drive[k + 1, i] - drive[k, i])


@compiled
def runge_kutta_stages(
    chain: Chain,
    law: Floats,
    given: bool,
    drive: Floats,
    k: int,
    start: float,
    share: float,
    dt: float,
    q: Floats,
    dq: Floats,
    mode: Floats,
    room: Room,
    slopes: Floats,
    after: Floats,
) -> None:
    """Fill in the state ``after`` (2, n) a share of step ``k``, whose part before ``start`` is done.

    ``slopes`` (2, 4, n) are the derivatives of q and dq at the four stages; dq's first one is given.
    """
    h = share * dt
    slopes[0, 0] = dq
    for stage in range(1, 4):
        part = 1.0 if stage == 3 else 0.5
        for i in range(q.size):
            after[0, i] = q[i] + part * h * slopes[0, stage - 1, i]
            after[1, i] = dq[i] + part * h * slopes[1, stage - 1, i]
            slopes[0, stage, i] = after[1, i]
        drive_at(drive, k, start + part * share, given, room.now)
        equations(chain, law, given, after[0], after[1], room.now, room)
        acceleration(chain, mode, room, slopes[1, stage])
    for i in range(q.size):
        v, a = slopes[0], slopes[1]
        after[0, i] = q[i] + h / 6.0 * (v[0, i] + 2.0 * v[1, i] + 2.0 * v[2, i] + v[3, i])
        after[1, i] = dq[i] + h / 6.0 * (a[0, i] + 2.0 * a[1, i] + 2.0 * a[2, i] + a[3, i])


@compiled
def runge_kutta_steps(
    chain: Chain, law: Floats, given: bool, drive: Floats, dt: float, state: Floats, motion: Floats
) -> None:
    """Fill in a motion by fourth-order Runge-Kutta steps, cut where a joint comes to rest."""
    n_sample, n = drive.shape
    room = make_room(n)
    q, dq, mode = state[0].copy(), state[1].copy(), np.zeros(n)
    slopes, after = np.empty((2, 4, n)), np.empty((2, n))
    for k in range(n_sample):
        done = 0.0
        for cut in range(_CUTS):
            drive_at(drive, k, done, given, room.now)
            equations(chain, law, given, q, dq, room.now, room)
            choose_modes(chain, dq, mode, room, slopes[1, 0])
            acceleration(chain, mode, room, slopes[1, 0])
            if cut == 0:
                record(law, given, room.now, q, dq, slopes[1, 0], motion[:, k])
            share = 1.0 - done
            runge_kutta_stages(chain, law, given, drive, k, done, share, dt, q, dq, mode, room, slopes, after)
            joint, part = first_to_rest(chain, dq, after[1], mode)
            if joint >= 0:
                share *= part
                for _ in range(5):  # Newton's steps on the time at which the joint comes to rest
                    runge_kutta_stages(
                        chain, law, given, drive, k, done, share, dt, q, dq, mode, room, slopes, after
                    )
                    better = share - after[1, joint] / (slopes[1, 3, joint] * dt)
                    if abs(better - share) < 1e-12 or not 0.0 < better < 1.0 - done:
                        break
                    share = better
                after[1, joint] = 0.0
            q[:], dq[:] = after[0], after[1]
            done += share
            if joint < 0 or done >= 1.0 - 1e-9:
                break


@compiled
def record(law: Floats, given: bool, drive: Floats, q: Floats, dq: Floats, ddq: Floats, row: Floats) -> None:
    """Fill in one sample of a motion: row (4, n)."""
    for i in range(q.size):
        row[0, i], row[1, i], row[2, i] = q[i], dq[i], ddq[i]
        tau = law[0, i] * (drive[i] - q[i]) + law[1, i] * dq[i] + law[2, i] * ddq[i]  # eq. (5), (6), (7)
        row[3, i] = drive[i] if given else tau


@compiled
def first_to_rest(chain: Chain, dq: Floats, after: Floats, mode: Floats) -> tuple[int, float]:
    """Return the joint that first reverses within a step and the share of the step it takes; -1 if none."""
    joint, share = -1, 1.0
    for i in range(dq.size):
        direction_matters = chain.friction[i, 1] != 0.0 or chain.friction[i, 2] > 0.0
        if direction_matters and mode[i] != 0.0 and dq[i] != 0.0 and after[i] * mode[i] < 0.0:
            rest = dq[i] / (dq[i] - after[i])
            if rest < share:
                joint, share = i, rest
    return joint, share


@compiled
def paper_steps(
    chain: Chain, law: Floats, given: bool, drive: Floats, dt: float, state: Floats, motion: Floats
) -> None:
    """Fill in a motion as section 7 prints it: Runge-Kutta on the velocity alone, then Euler on the angle."""
    n_sample, n = drive.shape
    room = make_room(n)
    q, dq, mode, trial = state[0].copy(), state[1].copy(), np.zeros(n), np.empty(n)
    slope, part = np.empty((4, n)), (0.0, 0.5, 0.5, 1.0)
    for k in range(n_sample):
        for stage in range(4):
            for i in range(n):
                trial[i] = dq[i] + part[stage] * dt * slope[max(stage - 1, 0), i] if stage else dq[i]
            equations(chain, law, given, q, trial, drive[k], room)  # theta is frozen within the step
            choose_modes(chain, trial, mode, room, slope[stage])
            acceleration(chain, mode, room, slope[stage])
        record(law, given, drive[k], q, dq, slope[0], motion[:, k])
        for i in range(n):
            dq[i] += dt / 6.0 * (slope[0, i] + 2.0 * slope[1, i] + 2.0 * slope[2, i] + slope[3, i])
            q[i] += dt * dq[i]  # theta^(t+1) = theta^t + dtheta^(t+1) h
