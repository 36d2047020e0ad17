"""The compiled steps of `arm.simulation`.

``state`` (2, n_joint) is q, dq of the links. ``motion`` (4, n_sample, n_joint) takes their q, dq, ddq and the
torque that is asked for; ``lead`` (2, n_sample, n_joint), or without samples, takes by how much the motors' angles
lead those of the links, and how fast that grows.
"""

import numpy as np

from arm.chain import Chain
from arm.drive import (
    COMMAND,
    GUESS,
    PLAY,
    PLAY_SPEED,
    TWIST,
    TWIST_SPEED,
    Commands,
    begin_stretch,
    end_stretch,
)
from arm.drive_state import ON
from arm.effects.effect_table import EffectTable, no_effects
from arm.effects.joint_numbers import LIMIT
from arm.mode_end import CUT_AT, begin_bracket, narrow, next_try
from arm.model import Floats
from arm.motion_equations import acceleration, equations
from arm.resistance import friction_alone, take_up
from arm.room import Room, make_room
from arm.sticking import choose_modes, slack_of, stop_reversed
from limbcal.compiled import borrowed, compiled, inlined

#: How often one step may be cut by joints that come to rest or let go.
_CUTS = 16
#: How often an acceleration is sought on which its own torque depends otherwise than linearly, and how exactly.
_ROUNDS, _FOUND = 20, 1e-12


@inlined
def accelerate(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    k: int,
    share: float,
    h: float,
    q: Floats,
    dq: Floats,
    mode: Floats,
    room: Room,
    ddq: Floats,
) -> None:
    """Set up the equations at a share of step ``k``, ``h`` seconds into a stretch, and solve them.

    At its start (``h`` is 0) the modes are chosen, for all of it. Where law (6) feeds the acceleration back,
    limits and friction depend on it too: then it is found in rounds.
    """
    implicit = False
    if effects.driven or effects.joint.size > 0:
        for i in range(q.size):
            implicit = implicit or commands.law[2, i] != 0.0
    guess = room.way.state[GUESS]
    for _ in range(_ROUNDS if implicit else 1):
        if h == 0.0:
            for i in range(q.size):
                mode[i] = np.sign(dq[i])
        equations(chain, commands, effects, k, share, h, q, dq, mode, room)
        if h == 0.0:
            choose_modes(dq, mode, room, ddq)
        acceleration(mode, room, ddq)
        if implicit:
            off = 0.0
            for i in range(q.size):
                off = max(off, abs(ddq[i] - guess[i]) / (1.0 + abs(ddq[i])))
                guess[i] = ddq[i]
            if not off > _FOUND:
                break


@inlined
def runge_kutta_stages(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    k: int,
    start: float,
    share: float,
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
    h = share * commands.dt
    slopes[0, 0] = dq
    for stage in range(1, 4):
        part = 1.0 if stage == 3 else 0.5
        for i in range(q.size):
            after[0, i] = q[i] + part * h * slopes[0, stage - 1, i]
            after[1, i] = dq[i] + part * h * slopes[1, stage - 1, i]
            slopes[0, stage, i] = after[1, i]
        at = start + part * share
        accelerate(chain, commands, effects, k, at, part * h, after[0], after[1], mode, room, slopes[1, stage])
    for i in range(q.size):
        v, a = slopes[0], slopes[1]
        after[0, i] = q[i] + h / 6.0 * (v[0, i] + 2.0 * v[1, i] + 2.0 * v[2, i] + v[3, i])
        after[1, i] = dq[i] + h / 6.0 * (a[0, i] + 2.0 * a[1, i] + 2.0 * a[2, i] + a[3, i])


@inlined
def modes_end(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    k: int,
    share: float,
    h: float,
    state: Floats,
    mode: Floats,
    room: Room,
    slack: Floats,
) -> bool:
    """Say whether in a state (2, n), a share of step ``k`` on, a joint has reversed or a stuck one lets go.

    ``slack`` (n,) takes how far each joint is from that. The stretch began ``h`` seconds before.
    """
    stuck = False
    for i in range(mode.size):
        stuck = stuck or mode[i] == 0.0
    if stuck:
        accelerate(chain, commands, effects, k, share, h, state[0], state[1], mode, room, room.bias)
    ends = False
    for i in range(mode.size):
        slack[i] = slack_of(i, mode, state[1], room, room.bias)
        ends = ends or slack[i] < 0.0
    return ends


@compiled
def effect_steps(
    chain: Chain,
    commands: Commands,
    effects: EffectTable,
    room: Room,
    state: Floats,
    motion: Floats,
    lead: Floats,
    schedule: Floats,
) -> None:
    """Fill in a motion by fourth-order Runge-Kutta steps, cut where a joint comes to rest or lets go.

    ``room.way`` must be as it was before the first sample. Loads that the arm takes up become part of ``chain``.
    ``schedule`` (n_sample, 4, n_joint), or without samples, has the gains that become the law's with each sample,
    and whether the drive is engaged, see `arm.drive_state`.
    """
    # the caller keeps them all; to count who looks at them would take four fifths of a step
    chain, commands, effects, room = borrowed(chain), borrowed(commands), borrowed(effects), borrowed(room)
    n_sample, n = commands.drive.shape
    limit = effects.numbers[LIMIT].copy()
    friction_alone(chain, effects, room)
    q, dq, mode = state[0].copy(), state[1].copy(), np.zeros(n)
    slopes, after, taken = np.empty((2, 4, n)), np.empty((2, n)), 0
    slack, bracket = np.empty(n), np.empty((2, 1 + n))
    for k in range(n_sample):
        done = 0.0
        if schedule.shape[0] > 0:
            engage(commands, effects, schedule[k], limit)
        taken = take_up(effects, chain, commands.t0 + k * commands.dt, taken)
        for cut in range(_CUTS):
            accelerate(chain, commands, effects, k, done, 0.0, q, dq, mode, room, slopes[1, 0])
            if cut == 0:
                record(commands, effects, room, k, q, dq, slopes[1, 0], motion, lead)
            ends = begin_stretch(commands, effects, room.way, k, done, dq, slopes[1, 0]) if effects.driven else 1.0
            whole = (ends if cut < _CUTS - 1 else 1.0) - done
            begin_bracket(bracket, whole, mode, dq, room, slopes[1, 0])
            share, found, rounds, side = whole, False, 0, -1
            while True:  # the first time through to the end; then the cut is sought, if a mode ends on the way
                h = share * commands.dt
                runge_kutta_stages(chain, commands, effects, k, done, share, q, dq, mode, room, slopes, after)
                if found or cut == _CUTS - 1:
                    break
                ended = modes_end(chain, commands, effects, k, done + share, h, after, mode, room, slack)
                if not ended and not share < whole:  # nor where all has run away and nothing is a number any more
                    break
                side = narrow(bracket, side, share, slack, ended)
                rounds += 1
                found = bracket[1, 0] - bracket[0, 0] <= CUT_AT
                share = bracket[1, 0] if found else next_try(bracket, rounds, side)
            if found:
                stop_reversed(mode, after[1], room)
            q[:], dq[:] = after[0], after[1]
            done += share
            if effects.driven:
                end_stretch(commands, effects, room.way, k, done, h, q, dq, slopes[1, 3], room.now)
            if done >= 1.0 - CUT_AT:
                break


@inlined
def engage(commands: Commands, effects: EffectTable, now: Floats, limit: Floats) -> None:
    """Put the gains of a sample into the law; a drive that is not engaged is one whose limit is zero."""
    for i in range(limit.size):
        for gain in range(3):
            commands.law[gain, i] = now[gain, i]
        effects.numbers[LIMIT, i] = limit[i] if now[ON, i] != 0.0 else 0.0


def runge_kutta_steps(
    chain: Chain,
    law: Floats,
    given: bool,
    drive: Floats,
    dt: float,
    state: Floats,
    motion: Floats,
    schedule: Floats,
) -> None:
    """Fill in a motion without effects as `effect_steps` does; the rest is as in `Commands`.

    A kernel that calls another is optimised together with it: this one would take as long to compile again.
    """
    n = drive.shape[1]
    commands, lead = Commands(law.copy(), given, drive, dt, 0.0), np.empty((2, 0, n))
    effect_steps(chain, commands, no_effects(n), make_room(n, 0), state, motion, lead, schedule)


@inlined
def record(
    commands: Commands,
    effects: EffectTable,
    room: Room,
    k: int,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    motion: Floats,
    lead: Floats,
) -> None:
    """Fill in sample ``k`` of a motion."""
    law, drive, x = commands.law, room.now, room.way.state
    for i in range(q.size):
        motion[0, k, i], motion[1, k, i], motion[2, k, i] = q[i], dq[i], ddq[i]
        if effects.driven:
            motion[3, k, i] = x[COMMAND, i] + law[2, i] * ddq[i]
        else:
            tau = law[0, i] * (drive[i] - q[i]) + law[1, i] * dq[i] + law[2, i] * ddq[i]  # eq. (5), (6), (7)
            motion[3, k, i] = drive[i] if commands.given else tau
        if lead.shape[1] > 0:
            lead[0, k, i] = x[PLAY, i] + x[TWIST, i]
            lead[1, k, i] = x[PLAY_SPEED, i] + x[TWIST_SPEED, i]
