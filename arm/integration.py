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
    load: Floats
    wrench: Floats
    A: Floats
    M: Floats
    net: Floats
    bias: Floats
    still: Floats


@compiled
def make_room(n: int) -> Room:
    """Return the working arrays for ``n`` joints."""
    return Room(
        np.empty((n, 3, 3)),
        np.empty((n, 3)),
        np.empty((n, 3, 3)),
        np.empty((2, 3)),
        np.zeros(6),
        np.empty((n, n)),
        np.empty((n, n)),
        np.empty(n),
        np.empty(n),
        np.zeros(n),
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
def equations(
    chain: Chain, law: Floats, given: bool, q: Floats, dq: Floats, drive: Floats, room: Room
) -> None:
    """Set up ``M ddq = net``: the law's share of ddq is on the left, Coulomb friction is not in it."""
    n = q.size
    poses(chain, q, room.R, room.p)
    mass_columns(chain, room.R, room.p, room.motion, room.load, room.M)
    rigid_motion(chain, chain.gravity, room.R, room.p, dq, room.still, room.motion)
    rigid_torque(chain, room.R, room.p, room.motion, room.wrench, room.load, room.bias)
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
def runge_kutta_steps(
    chain: Chain, law: Floats, given: bool, drive: Floats, dt: float, state: Floats, motion: Floats
) -> None:
    """Fill in a motion by fourth-order Runge-Kutta steps, cut where a joint comes to rest."""
    n_sample, n = drive.shape
    room = make_room(n)
    q, dq, mode, now = state[0].copy(), state[1].copy(), np.zeros(n), np.empty(n)
    k_q, k_dq, trial_q, trial_dq = np.empty((4, n)), np.empty((4, n)), np.empty(n), np.empty(n)
    for k in range(n_sample):
        done = 0.0
        for cut in range(_CUTS):
            drive_at(drive, k, done, given, now)
            equations(chain, law, given, q, dq, now, room)
            choose_modes(chain, dq, mode, room, k_dq[0])
            acceleration(chain, mode, room, k_dq[0])
            if cut == 0:
                for i in range(n):
                    motion[0, k, i], motion[1, k, i], motion[2, k, i] = q[i], dq[i], k_dq[0, i]
                    tau = law[0, i] * (now[i] - q[i]) + law[1, i] * dq[i] + law[2, i] * k_dq[0, i]  # eq. (6)
                    motion[3, k, i] = now[i] if given else tau
            share = 1.0 - done
            joint = -1
            for _ in range(6):  # at most a few repetitions, to find when a joint comes to rest
                h = share * dt
                k_q[0] = dq
                for stage in range(1, 4):
                    part = 1.0 if stage == 3 else 0.5
                    for i in range(n):
                        trial_q[i] = q[i] + part * h * k_q[stage - 1, i]
                        trial_dq[i] = dq[i] + part * h * k_dq[stage - 1, i]
                        k_q[stage, i] = trial_dq[i]
                    drive_at(drive, k, done + part * share, given, now)
                    equations(chain, law, given, trial_q, trial_dq, now, room)
                    acceleration(chain, mode, room, k_dq[stage])
                for i in range(n):
                    trial_q[i] = q[i] + h / 6.0 * (k_q[0, i] + 2.0 * k_q[1, i] + 2.0 * k_q[2, i] + k_q[3, i])
                    trial_dq[i] = dq[i] + h / 6.0 * (
                        k_dq[0, i] + 2.0 * k_dq[1, i] + 2.0 * k_dq[2, i] + k_dq[3, i]
                    )
                if joint < 0:
                    joint, rest = first_to_rest(chain, dq, trial_dq, mode)
                    if joint < 0:
                        break
                    share *= rest
                else:  # Newton's step on the time of rest
                    slope = k_dq[3, joint] * dt
                    better = share - trial_dq[joint] / slope
                    if abs(better - share) < 1e-12 or not 0.0 < better < 1.0 - done:
                        break
                    share = better
            q[:], dq[:] = trial_q, trial_dq
            if joint >= 0:
                dq[joint] = 0.0
            done += share
            if joint < 0 or done >= 1.0 - 1e-9:
                break


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
        for i in range(n):
            tau = law[0, i] * (drive[k, i] - q[i]) + law[1, i] * dq[i] + law[2, i] * slope[0, i]
            motion[0, k, i], motion[1, k, i], motion[2, k, i] = q[i], dq[i], slope[0, i]
            motion[3, k, i] = drive[k, i] if given else tau
            dq[i] += dt / 6.0 * (slope[0, i] + 2.0 * slope[1, i] + 2.0 * slope[2, i] + slope[3, i])
            q[i] += dt * dq[i]  # theta^(t+1) = theta^t + dtheta^(t+1) h
