"""All numbers of a touched arm in three arrays.

A kernel that takes some fifty arrays spends ten times as long on taking them as on a step of the arm. So there are
three, and `laid_out` says what is where in them, to Python and, compiled, to the kernels.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.drive import N_ROW, Commands, Way
from arm.effects.effect_table import EffectTable
from arm.effects.joint_torque import MOST_PARAMETERS, N_STATE
from arm.model import Floats
from arm.room import Room
from limbcal.compiled import compiled
from playback.touch.coupling import N_ACCOUNT, N_NUMBER, Touch

#: What ``sizes`` has: joints, steps whose commands are kept, effects at joints, payloads.
JOINTS, PAST, EFFECTS, PAYLOADS = range(4)


class Parts(NamedTuple):
    """What is in the arrays.

    Attributes
    ----------
    chain, commands, effects, room, touch
        As the arm and the coupling know them; the commands' time is that of the last run of `laid_out`.
    state : (3, n_joint)
        q, dq of the links and the last ddq.
    slopes, after : (2, 4, n_joint), (3, n_joint)
        To work in.
    clock : (2,)
        The run's time, and the step [s].
    counts : (2,) int
        How many payloads the arm carries; whether it is free of its law (1) or not.
    """

    chain: Chain
    commands: Commands
    effects: EffectTable
    room: Room
    touch: Touch
    state: Floats
    slopes: Floats
    after: Floats
    clock: Floats
    counts: NDArray[np.int64]


@compiled
def laid_out(
    floats: Floats, whole: NDArray[np.int64], flags: NDArray[np.bool_], sizes: NDArray[np.int64]
) -> Parts:
    """Return the parts of the arrays, as views of them."""
    n, n_past, n_effect, n_payload = sizes[JOINTS], sizes[PAST], sizes[EFFECTS], sizes[PAYLOADS]
    rows = max(n_past, 1)
    a = 0
    geometry, a = floats[a : a + 5 * n].reshape((n, 5)), a + 5 * n
    inertial, a = floats[a : a + 10 * n].reshape((n, 10)), a + 10 * n
    friction, a = floats[a : a + 3 * n].reshape((n, 3)), a + 3 * n
    gravity, a = floats[a : a + 3], a + 3
    drag, a = floats[a : a + n], a + n
    law, a = floats[a : a + 3 * n].reshape((3, n)), a + 3 * n
    drive, a = floats[a : a + rows * n].reshape((rows, n)), a + rows * n
    size = MOST_PARAMETERS * n_effect
    parameters, a = floats[a : a + size].reshape((n_effect, MOST_PARAMETERS)), a + size
    numbers, a = floats[a : a + 8 * n].reshape((8, n)), a + 8 * n
    payload, a = floats[a : a + 2 * n_payload].reshape((n_payload, 2)), a + 2 * n_payload
    R, a = floats[a : a + 9 * n].reshape((n, 3, 3)), a + 9 * n
    p, a = floats[a : a + 3 * n].reshape((n, 3)), a + 3 * n
    motion, a = floats[a : a + 9 * n].reshape((n, 3, 3)), a + 9 * n
    zero, a = floats[a : a + n + 6], a + n + 6
    A, a = floats[a : a + n * n].reshape((n, n)), a + n * n
    M, a = floats[a : a + n * n].reshape((n, n)), a + n * n
    net, bias, now, slip, hold = (
        floats[a : a + n],
        floats[a + n : a + 2 * n],
        floats[a + 2 * n : a + 3 * n],
        floats[a + 3 * n : a + 4 * n],
        floats[a + 4 * n : a + 5 * n],
    )
    a += 5 * n
    seen, a = floats[a : a + N_STATE], a + N_STATE
    way, a = floats[a : a + N_ROW * n].reshape((N_ROW, n)), a + N_ROW * n
    past, a = floats[a : a + 2 * n_past * n].reshape((n_past, 2, n)), a + 2 * n_past * n
    state, a = floats[a : a + 3 * n].reshape((3, n)), a + 3 * n
    slopes, a = floats[a : a + 8 * n].reshape((2, 4, n)), a + 8 * n
    after, a = floats[a : a + 3 * n].reshape((3, n)), a + 3 * n
    clock, a = floats[a : a + 2], a + 2
    path, a = floats[a : a + 6].reshape((2, 3)), a + 6
    speed, a = floats[a : a + 6].reshape((2, 3)), a + 6
    felt, a = floats[a : a + 6].reshape((2, 3)), a + 6
    sent, a = floats[a : a + 6].reshape((2, 3)), a + 6
    frame, a = floats[a : a + 9].reshape((3, 3)), a + 9
    axes, a = floats[a : a + 9].reshape((3, 3)), a + 9
    moving, a = floats[a : a + 9].reshape((3, 3)), a + 9
    work, a = floats[a : a + 18].reshape((2, 3, 3)), a + 18
    point, twist, span, wall = (
        floats[a : a + 3],
        floats[a + 3 : a + 6],
        floats[a + 6 : a + 9],
        floats[a + 9 : a + 13],
    )
    a += 13
    coupling, a = floats[a : a + N_NUMBER], a + N_NUMBER
    account = floats[a : a + N_ACCOUNT]
    k = drive.shape[0] - 1
    return Parts(
        Chain(flags[:n], geometry, inertial, friction, gravity, drag),
        Commands(law, whole[2] != 0, drive, clock[1], clock[0] - k * clock[1]),
        EffectTable(
            whole[3 : 3 + n_effect],
            whole[3 + n_effect : 3 + 2 * n_effect],
            parameters,
            flags[n : 2 * n],
            numbers,
            flags[3 * n],
            flags[3 * n + 1],
            payload,
        ),
        Room(R, p, motion, zero, A, M, net, bias, now, slip, hold, flags[2 * n : 3 * n], seen, Way(way, past)),
        Touch(
            whole[:1],
            point,
            path,
            speed,
            frame,
            twist,
            span,
            wall,
            coupling,
            felt,
            sent,
            axes,
            moving,
            account,
            work,
        ),
        state,
        slopes,
        after,
        clock,
        whole[1:3],
    )


class Memory:
    """The arrays of one arm, filled with its numbers.

    Parameters
    ----------
    chain : Chain
    effects : EffectTable
    n_past : int
        Steps whose commands are kept for a delay.
    step_s : float
    """

    def __init__(self, chain: Chain, effects: EffectTable, n_past: int, step_s: float) -> None:
        n, n_effect, n_payload = len(chain.revolute), len(effects.joint), len(effects.payload)
        size = (81 + N_ROW) * n + 2 * n * n + (max(n_past, 1) + 2 * n_past) * n
        size += MOST_PARAMETERS * n_effect + 2 * n_payload + N_STATE + N_NUMBER + N_ACCOUNT + 110
        self.arrays = (
            np.zeros(size),
            np.zeros(3 + 2 * n_effect, dtype=np.int64),
            np.zeros(3 * n + 2, dtype=np.bool_),
            np.array([n, n_past, n_effect, n_payload]),
        )
        flags = self.arrays[2]
        flags[:n], flags[n : 2 * n] = chain.revolute, effects.directed
        flags[3 * n], flags[3 * n + 1] = effects.driven, effects.geared
        self.parts: Parts = laid_out.py_func(*self.arrays)  # type: ignore[attr-defined]
        for ours, theirs in ((self.parts.chain, chain), (self.parts.effects, effects)):
            for name in theirs._fields:
                if isinstance(getattr(theirs, name), np.ndarray):
                    getattr(ours, name)[:] = getattr(theirs, name)
        self.parts.clock[1] = step_s
        self.parts.touch.joint[0] = -1
        self.parts.touch.frame[:] = self.parts.touch.axes[:] = np.eye(3)
