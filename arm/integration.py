"""The compiled steps of `arm.simulation`.

``law`` (3, n_joint) holds kp, kv, ka. ``drive`` (n_sample, n_joint) is the target where the law is known and
the torque where it is measured. ``state`` (2, n_joint) is q, dq. ``motion`` (4, n_sample, n_joint) takes
q, dq, ddq, tau.
"""

import numpy as np

from arm.chain import Chain
from arm.model import Floats
from arm.motion_equations import Room, acceleration, equations, make_room
from arm.sticking import choose_modes, pull_beyond, reversed_joint
from limbcal.compiled import compiled

#: How often one step may be cut by joints that come to rest or let go.
_CUTS = 16
#: How exactly a cut is placed, as a share of the step.
_CUT_AT = 1e-13


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
def mode_changed(
    chain: Chain,
    law: Floats,
    given: bool,
    drive: Floats,
    k: int,
    share: float,
    state: Floats,
    mode: Floats,
    room: Room,
) -> bool:
    """Say whether in a state (2, n), a share of step ``k`` on, a joint has reversed or a stuck one lets go."""
    stuck = False
    for i in range(mode.size):
        if reversed_joint(chain, i, mode, state[1]):
            return True
        stuck = stuck or mode[i] == 0.0
    if stuck:
        drive_at(drive, k, share, given, room.now)
        equations(chain, law, given, state[0], state[1], room.now, room)
        acceleration(chain, mode, room, room.bias)
        for i in range(mode.size):
            if mode[i] == 0.0 and pull_beyond(chain, i, room, room.bias) != 0.0:
                return True
    return False


@compiled
def runge_kutta_steps(
    chain: Chain, law: Floats, given: bool, drive: Floats, dt: float, state: Floats, motion: Floats
) -> None:
    """Fill in a motion by fourth-order Runge-Kutta steps, cut where a joint comes to rest or lets go."""
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
            share, before, late = 1.0 - done, 0.0, 1.0 - done
            runge_kutta_stages(chain, law, given, drive, k, done, share, dt, q, dq, mode, room, slopes, after)
            if cut < _CUTS - 1 and mode_changed(chain, law, given, drive, k, 1.0, after, mode, room):
                while late - before > _CUT_AT:  # bisection
                    share = (before + late) / 2.0
                    runge_kutta_stages(
                        chain, law, given, drive, k, done, share, dt, q, dq, mode, room, slopes, after
                    )
                    if mode_changed(chain, law, given, drive, k, done + share, after, mode, room):
                        late = share
                    else:
                        before = share
                share = late
                runge_kutta_stages(chain, law, given, drive, k, done, share, dt, q, dq, mode, room, slopes, after)
                for i in range(n):
                    if reversed_joint(chain, i, mode, after[1]):
                        after[1, i] = 0.0
            q[:], dq[:] = after[0], after[1]
            done += share
            if done >= 1.0 - _CUT_AT:
                break


@compiled
def record(law: Floats, given: bool, drive: Floats, q: Floats, dq: Floats, ddq: Floats, row: Floats) -> None:
    """Fill in one sample of a motion: row (4, n)."""
    for i in range(q.size):
        row[0, i], row[1, i], row[2, i] = q[i], dq[i], ddq[i]
        tau = law[0, i] * (drive[i] - q[i]) + law[1, i] * dq[i] + law[2, i] * ddq[i]  # eq. (5), (6), (7)
        row[3, i] = drive[i] if given else tau


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
