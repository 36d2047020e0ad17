"""One tick of the touched arm, compiled: the hand's input, the arm's step, what the hand feels, the account.

The step is that of `arm.integration` but for two things that keep its price the same in every tick: where a joint
comes to rest is found by one straight line instead of bisection, and where law (6) feeds the acceleration back
to effects, that of the last step is taken.
"""

import numpy as np
from numpy.typing import NDArray

from arm.chain import poses
from arm.drive import GUESS, Commands, begin_stretch, end_stretch
from arm.model import Floats
from arm.motion_equations import acceleration, equations
from arm.outer_wrench import point_motion
from arm.resistance import take_up
from arm.room import Room
from arm.sticking import choose_modes, reversed_joint, stop_reversed
from limbcal.compiled import compiled, inlined
from playback.touch.coupling import (
    ARM,
    BRAKED,
    CREDIT,
    DEVICE,
    HAND,
    INJECTED,
    INTERVAL,
    LIMIT,
    STORED,
    TURN_DEVICE,
    TURN_LIMIT,
    WALL_LIMIT,
    WALL_STIFFNESS,
    Touch,
    couple,
    depth,
    length,
    pull,
    stored,
)
from playback.touch.memory import Parts, laid_out
from playback.touch.rotation import turned_on

#: Into how many stretches a step is cut at most, and the shortest one, as a share of the step.
_STRETCHES, _SHORTEST = 3, 1e-3
#: A step is done at this fraction of it: one less what rounding adds up to.
_DONE = 1.0 - 1e-13
#: Share of its speed that a joint may have left where a straight line says that it rests.
_LEFT = 1e-3
#: Share of the energy that has passed by which additions may round.
_ROUNDING = 1e-12


@inlined
def first_reversal(mode: Floats, dq: Floats, after: Floats, room: Room) -> float:
    """Return the part of a stretch after which the first joint comes to rest, 1 where none does."""
    first = 1.0
    for i in range(dq.size):
        if reversed_joint(i, mode, after, room):
            first = min(first, dq[i] / (dq[i] - after[i]))
    return first


@inlined
def runge_kutta_state(q: Floats, dq: Floats, slopes: Floats, stage: int, h: float, after: Floats) -> None:
    """Fill in the state ``after`` at a stage (0 to 3) of a stretch of ``h`` seconds, or at its end (4)."""
    v, a = slopes[0], slopes[1]
    for i in range(q.size):
        after[0, i], after[1, i] = q[i], dq[i]
        if stage == 4:
            after[0, i] += h / 6.0 * (v[0, i] + 2.0 * v[1, i] + 2.0 * v[2, i] + v[3, i])
            after[1, i] += h / 6.0 * (a[0, i] + 2.0 * a[1, i] + 2.0 * a[2, i] + a[3, i])
        elif stage > 0:
            part = h if stage == 3 else h / 2.0
            after[0, i] += part * v[stage - 1, i]
            after[1, i] += part * a[stage - 1, i]
        if stage < 4:
            slopes[0, stage, i] = after[1, i]


@inlined
def come_to_rest(again: bool, mode: Floats, dq: Floats, after: Floats, room: Room) -> None:
    """Stop what has turned round, and what the straight line says has come to rest."""
    for i in range(dq.size):
        if again and mode[i] != 0.0 and room.directed[i] and abs(after[i]) <= _LEFT * abs(dq[i]):
            after[i] = 0.0
    stop_reversed(mode, after, room)


@compiled
def hear(touch: Touch, heard: bool) -> None:
    """Put down what has changed since the last tick: stiffness, and where the hand is if it was ``heard``."""
    account, x = touch.account, touch.numbers
    account[INJECTED] += stored(touch, 0.0) - account[STORED]
    if heard:
        moved, turned = 0.0, 0.0
        for row in range(3):
            d = touch.path[1, row] - touch.path[0, row]
            account[HAND] -= touch.sent[0, row] * d + touch.sent[1, row] * touch.twist[row]
            moved += d * d
            turned += touch.twist[row] * touch.twist[row]
        account[CREDIT] += (x[DEVICE] * moved + x[TURN_DEVICE] * turned) / x[INTERVAL]


@compiled
def feel(parts: Parts, heard: bool) -> None:
    """Fill in what the hand feels and what is stored; the hand's move is over, and it is sent if ``heard``."""
    chain, touch, room, state = parts.chain, parts.touch, parts.room, parts.state
    account, x = touch.account, touch.numbers
    touch.felt[:] = 0.0
    if touch.joint[0] >= 0:
        poses(chain, state[0], room.R, room.p)
        point_motion(chain, room.R, room.p, state[1], touch.joint[0], touch.point, touch.axes, touch.moving)
        v, w = touch.seen[0], touch.seen[1]
        f, m = pull(touch, 1.0, v[0], v[1], v[2], w[0], w[1], w[2])
        push = min(x[WALL_STIFFNESS] * depth(touch, 1.0), x[WALL_LIMIT])
        for row in range(3):
            touch.felt[0, row] = push * touch.wall[row] - f[row]
            touch.felt[1, row] = -m[row]
    account[STORED] = stored(touch, 1.0)
    touch.path[0] = touch.path[1]
    if touch.joint[0] >= 0:
        turned_on(touch.frame, touch.twist, 1.0, touch.room[0], touch.room[1])
        touch.frame[:] = touch.room[1]
        touch.twist[:] = 0.0
        brake(touch)
    if heard:
        touch.sent[:] = touch.felt


@compiled
def brake(touch: Touch) -> None:
    """Resist the hand where more energy has come out than went in: the passivity controller.

    The account is short by so much; a damper on the hand takes it within one tick, if the device's own damping is
    at least as strong.
    """
    account, x = touch.account, touch.numbers
    slack = account[HAND] + account[INJECTED] + account[CREDIT] - account[ARM] - account[STORED]
    if slack >= -_ROUNDING * (1.0 + abs(account[HAND]) + abs(account[ARM])):
        return
    account[BRAKED] += 1.0
    for part, damping, limit in (
        (0, x[DEVICE], x[LIMIT] + x[WALL_LIMIT]),
        (1, x[TURN_DEVICE], x[TURN_LIMIT]),
    ):
        v = touch.seen[part]
        square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
        if square == 0.0:
            continue
        f = touch.felt[part]
        resistance = min(-slack / (x[INTERVAL] * square), damping)
        for row in range(3):
            f[row] -= resistance * v[row]
        strength = length((f[0], f[1], f[2]))
        if strength > limit:
            for row in range(3):
                f[row] *= limit / strength


@compiled
def begin_step(parts: Parts) -> None:
    """Take up what the arm carries from now on, and move the commands that a delay looks back on one step away."""
    past = parts.room.way.past
    parts.counts[0] = take_up(parts.effects, parts.chain, parts.clock[0], parts.counts[0])
    for j in range(past.shape[0] - 1):
        past[j] = past[j + 1]


@compiled
def tick(  # noqa: PLR0915 - each kernel that calls another is compiled with all of it once more
    floats: Floats,
    whole: NDArray[np.int64],
    flags: NDArray[np.bool_],
    sizes: NDArray[np.int64],
    n_step: int,
    heard: bool,
) -> None:
    """Take the arm some steps on by Runge-Kutta, the hand moving meanwhile, and say what it feels then.

    The modes of the joints are chosen at the start of a stretch, for all of it. A stretch is gone through twice
    where a joint comes to rest in it: the first time shows where.

    Parameters
    ----------
    floats, whole, flags, sizes
        As `playback.touch.memory` has them.
    n_step : int
    heard : bool
        Whether ``touch.path[1]`` is a new place, and its sender hears what it feels there.
    """
    parts = laid_out(floats, whole, flags, sizes)
    chain, effects, touch, room, state, slopes, after, clock = (
        parts.chain,
        parts.effects,
        parts.touch,
        parts.room,
        parts.state,
        parts.slopes,
        parts.after,
        parts.clock,
    )
    hear(touch, heard)
    q, dq, mode, commands = state[0], state[1], after[2], parts.commands
    k, dt = commands.drive.shape[0] - 1, clock[1]
    touch.span[1], touch.span[2] = n_step, dt
    done, share, first_power, cut, again, step, fresh = 0.0, 1.0, 0.0, 0, False, 0, True
    while step < n_step:
        last = cut == _STRETCHES - 1
        if fresh:
            touch.span[0] = step
            commands = Commands(commands.law, commands.given, commands.drive, dt, clock[0] - k * dt)
            begin_step(parts)
            done, share, cut, again, fresh, last = 0.0, 1.0, 0, False, False, False
        h, more = share * dt, 0.0
        for stage in range(1 if again else 0, 4):  # the first stage is the same both times
            part = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5
            runge_kutta_state(q, dq, slopes, stage, h, after)
            at = done + part * share
            if stage == 0:
                for i in range(q.size):
                    mode[i] = np.sign(dq[i])
            equations(chain, commands, effects, k, at, part * h, after[0], after[1], mode, room)
            power = couple(chain, touch, room.R, room.p, after[1], at, room.net)
            if stage == 0:
                choose_modes(dq, mode, room, slopes[1, 0])
            acceleration(mode, room, slopes[1, stage])
            if stage == 0:
                first_power = power
                if effects.driven:
                    share = begin_stretch(commands, effects, room.way, k, done, dq, slopes[1, 0]) - done
                    share = 1.0 - done if last else share
                    h = share * dt
            else:
                more += (1.0 if stage == 3 else 2.0) * power
        runge_kutta_state(q, dq, slopes, 4, h, after)
        first = 1.0 if again or last else first_reversal(mode, dq, after[1], room)
        if first < 1.0:
            share, again = max(first * share, min(_SHORTEST, share)), True
            continue
        come_to_rest(again, mode, dq, after[1], room)
        touch.account[ARM] += h / 6.0 * (first_power + more)
        q[:], dq[:] = after[0], after[1]
        done += share
        if effects.driven:
            end_stretch(commands, effects, room.way, k, done, h, q, dq, slopes[1, 3], room.now)
        room.way.state[GUESS] = slopes[1, 3]
        cut, share, again = cut + 1, 1.0 - done, False
        if done >= _DONE or last:
            clock[0] += dt
            step, fresh = step + 1, True
    state[2] = slopes[1, 3]
    feel(parts, heard)
