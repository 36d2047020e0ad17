"""The torque's way from the controller to the joint, and the angle's way back.

Along it a command u comes late (delay d), follows slowly (time constant T), counts ``factor`` times and is cut at
a limit, in this order; then the transmission passes it on, whose motor side leads the link by play and twist. The
controller sees the motor's side: its own motion is part of its command. All of it is linear in the command, so
what the joint gets is ``TORQUE + SHARE * ka * ddq``, and the acceleration that law (6) feeds back stays with M.

Lag and twist are linear equations of first order, ``T x' = y - x``. Over a stretch in which y runs straight from
y0 to y the exact solution is taken, whatever T is (the exponential integrator of second order):

    x = y - T m + (x0 - y0 + T m) exp(-h / T),    m = (y - y0) / h
"""

import math
from typing import NamedTuple

import numpy as np

from arm.effects.backlash import CROSSING_S
from arm.effects.effect_table import EffectTable
from arm.effects.joint_numbers import DAMPING, DELAY, FACTOR, GAP, LAG, LIMIT, STIFFNESS
from arm.model import Floats
from limbcal.compiled import compiled, inlined

#: Rows of the state, a number a joint. A stretch is a step of the simulation or a part of it; at its start are
#: what enters the lag, what leaves it, the play, the twist and what the twist tends to (0 in the name). Now are
#: the constant part of the torque and what ka ddq counts in it, the command, the last acceleration, and the others
#: once more, with the speeds of play and twist. Before the first sample was BEFORE; SLOPE is the command's at the
#: start of the step.
(
    ENTERED0, LAGGED0, PLAY0, TWIST0, TARGET0,
    TORQUE, SHARE, COMMAND, GUESS, ENTERED, THROUGH, LAGGED, PLAY, PLAY_SPEED, TWIST, TWIST_SPEED, TARGET,
    BEFORE, SLOPE,
) = range(19)  # fmt: skip
N_ROW = 19
#: A twist without damping follows its torque with this time constant [s].
_SHORTEST_S = 1e-6
#: A shorter delay is none [s].
_INSTANT_S = 1e-9
#: How near two instants are that count as one, in steps; and by how much a command must jump to be cut at.
_SAME, _JUMP = 1e-9, 1e-6


class Commands(NamedTuple):
    """What drives a simulation.

    ``law`` (3, n_joint) holds kp, kv, ka. ``drive`` (n_sample, n_joint) is the target where the law is known and
    the torque where it is ``given``. ``t0`` is the run's time at the first sample.
    """

    law: Floats
    given: bool
    drive: Floats
    dt: float
    t0: float


class Way(NamedTuple):
    """Where the torque is on its way: ``state`` (19, n_joint) and the commands at every step's start and end."""

    state: Floats
    past: Floats


@inlined
def drive_at(commands: Commands, k: int, share: float, out: Floats) -> None:
    """Fill in target (held) or torque (linear) at a share of the step after sample ``k``."""
    drive = commands.drive
    last = drive.shape[0] - 1
    for i in range(out.size):
        out[i] = drive[k, i]
        if commands.given and k < last:
            out[i] += share * (drive[k + 1, i] - drive[k, i])


@compiled
def delayed(commands: Commands, way: Way, k: int, share: float, h: float, delay: float, i: int) -> float:
    """Return the command of joint ``i`` some time before a share of step ``k``, ``h`` seconds into a stretch.

    Where it jumped, a stretch begins with what came after and ends with what was before.
    """
    at = k + share - delay / commands.dt
    j = min(math.floor(at + _SAME if h == 0.0 else at - _SAME), k)
    if j < 0:
        return float(way.state[BEFORE, i])
    if commands.given:
        after = min(j + 1, commands.drive.shape[0] - 1)
        return float(commands.drive[j, i] + (at - j) * (commands.drive[after, i] - commands.drive[j, i]))
    if j < k:
        return float(way.past[j, 0, i] + (at - j) * (way.past[j, 1, i] - way.past[j, 0, i]))
    return float(way.past[k, 0, i] + (at - k) * commands.dt * way.state[SLOPE, i])


@compiled
def next_jump(commands: Commands, effects: EffectTable, way: Way, k: int, share: float) -> float:
    """Return the share of step ``k`` at which the next jump of a delayed command arrives; 1 if none does."""
    nearest = 1.0
    for i in range(way.state.shape[1]):
        delay = effects.numbers[DELAY, i] / commands.dt
        j = math.floor(k + share - delay + _SAME) + 1
        arrives = j + delay - k
        if effects.numbers[DELAY, i] <= _INSTANT_S or j < 0 or j > k or arrives >= nearest - _SAME:
            continue
        before, after = way.state[BEFORE, i], commands.drive[0, i]
        if not commands.given:
            before, after = way.past[j - 1, 1, i] if j > 0 else before, way.past[j, 0, i]
        if (j == 0 or not commands.given) and abs(after - before) > _JUMP * (1.0 + abs(before)):
            nearest = arrives
    return nearest


@compiled
def transmitted(
    asked: float,
    kp: float,
    kv: float,
    rest: float,
    share: float,
    numbers: Floats,
    h: float,
    side: float,
    x: Floats,
) -> float:
    """Return the torque that a transmission passes on; fill in play, twist and the command that goes with them.

    The command without play and twist is ``asked``; ``rest + share u`` is what arrives of a command u. The play
    tends to ``side`` (from -1 to 1) times half the gap. ``x`` is the joint's column of the state.
    """
    end = side * numbers[GAP] / 2.0
    x[PLAY] = end + (x[PLAY0] - end) * math.exp(-h / CROSSING_S)
    x[PLAY_SPEED] = (end - x[PLAY]) / CROSSING_S
    asked += kv * x[PLAY_SPEED] - kp * x[PLAY]
    x[TWIST], x[TWIST_SPEED] = 0.0, 0.0
    if numbers[STIFFNESS] < np.inf:  # k x + d x' = rest + share (asked - kp x + kv x')
        stiffness = numbers[STIFFNESS] + share * kp
        T = max((numbers[DAMPING] - share * kv) / stiffness, _SHORTEST_S)
        x[TARGET] = (rest + share * asked) / stiffness
        if h > 0.0:
            m = (x[TARGET] - x[TARGET0]) / h
            fading = (x[TWIST0] - x[TARGET0] + T * m) * math.exp(-h / T)
            x[TWIST] = x[TARGET] - T * m + fading
            x[TWIST_SPEED] = m - fading / T
        else:
            x[TWIST], x[TWIST_SPEED] = x[TWIST0], (x[TARGET] - x[TWIST0]) / T
    x[COMMAND] = asked + kv * x[TWIST_SPEED] - kp * x[TWIST]
    return float(rest + share * x[COMMAND])


@compiled
def through_play(
    asked: float, kp: float, kv: float, rest: float, share: float, numbers: Floats, h: float, x: Floats
) -> float:
    """Return the torque that a transmission passes on, whichever side of its play it pushes.

    It pushes forwards if it would do so there, backwards likewise, and else it is on its way from one side to the
    other and passes on nothing: the torque falls linearly with the side that the play tends to.
    """
    forwards = transmitted(asked, kp, kv, rest, share, numbers, h, 1.0, x)
    if numbers[GAP] == 0.0 or forwards > 0.0:
        return forwards
    backwards = transmitted(asked, kp, kv, rest, share, numbers, h, -1.0, x)
    if backwards < 0.0:
        return backwards
    if backwards > forwards:
        side = (backwards + forwards) / (backwards - forwards)
    else:  # neither pushes nor is held by its controller: it stays
        side = 2.0 * x[PLAY0] / numbers[GAP]
    return transmitted(asked, kp, kv, rest, share, numbers, h, side, x)


@compiled
def go_its_way(
    commands: Commands,
    effects: EffectTable,
    way: Way,
    k: int,
    share: float,
    h: float,
    q: Floats,
    dq: Floats,
    now: Floats,
) -> None:
    """Find what the joints get at a share of step ``k``, ``h`` seconds into a stretch: TORQUE and SHARE.

    ``q, dq`` are the links', ``now`` the target or torque of that instant.
    """
    for i in range(q.size):
        numbers, x = effects.numbers[:, i], way.state[:, i]
        kp, kv, ka = commands.law[0, i], commands.law[1, i], commands.law[2, i]
        asked = now[i] if commands.given else kp * (now[i] - q[i]) + kv * dq[i]
        entering, through = 0.0, 1.0
        if numbers[DELAY] > _INSTANT_S:
            entering, through = delayed(commands, way, k, share, h, numbers[DELAY], i), 0.0
        rest, straight = 0.0, 1.0
        if numbers[LAG] > 0.0:
            fade = math.exp(-h / numbers[LAG])
            straight = 1.0 - (1.0 - fade) * numbers[LAG] / h if h > 0.0 else 0.0
            rest = (1.0 - fade - straight) * x[ENTERED0] + fade * x[LAGGED0]
        constant = numbers[FACTOR] * (rest + straight * entering)
        counted = numbers[FACTOR] * straight * through
        torque = through_play(asked, kp, kv, constant, counted, numbers, h, x)
        if abs(torque + counted * ka * x[GUESS]) > numbers[LIMIT]:
            constant = math.copysign(numbers[LIMIT], torque + counted * ka * x[GUESS])
            counted = 0.0
            torque = through_play(asked, kp, kv, constant, counted, numbers, h, x)
        x[TORQUE], x[SHARE], x[THROUGH] = torque, counted, through
        x[ENTERED] = entering + through * x[COMMAND]
        x[LAGGED] = rest + straight * (x[ENTERED] + through * ka * x[GUESS])


@compiled
def begin_stretch(
    commands: Commands, effects: EffectTable, way: Way, k: int, share: float, dq: Floats, ddq: Floats
) -> float:
    """Begin a stretch at a share of step ``k``, as `go_its_way` found it; return where it must end at last."""
    x = way.state
    for i in range(dq.size):
        fed_back = commands.law[2, i] * ddq[i]
        x[ENTERED0, i] = x[ENTERED, i] + x[THROUGH, i] * fed_back
        x[TARGET0, i] = x[TARGET, i]
        if share == 0.0 and way.past.shape[0] > 0:
            way.past[k, 0, i] = x[COMMAND, i] + fed_back
            x[SLOPE, i] = commands.law[1, i] * ddq[i] - commands.law[0, i] * dq[i]
    return next_jump(commands, effects, way, k, share)


@compiled
def end_stretch(
    commands: Commands,
    effects: EffectTable,
    way: Way,
    k: int,
    share: float,
    h: float,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    now: Floats,
) -> None:
    """End a stretch of ``h`` seconds at a share of step ``k``; ``now`` is room to work in."""
    x = way.state
    x[GUESS] = ddq
    drive_at(commands, k, share, now)
    go_its_way(commands, effects, way, k, share, h, q, dq, now)
    for i in range(q.size):
        x[LAGGED0, i], x[PLAY0, i], x[TWIST0, i] = x[LAGGED, i], x[PLAY, i], x[TWIST, i]
        if way.past.shape[0] > 0:
            way.past[k, 1, i] = x[COMMAND, i] + commands.law[2, i] * x[GUESS, i]
