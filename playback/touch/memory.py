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
from limbcal.compiled import cut, inlined
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


@inlined
def laid_out(  # noqa: PLR0915 - a line a part
    floats: Floats, whole: NDArray[np.int64], flags: NDArray[np.bool_], sizes: NDArray[np.int64]
) -> Parts:
    """Return the parts of the arrays, as views of them."""
    n, n_past, n_effect, n_payload = sizes[JOINTS], sizes[PAST], sizes[EFFECTS], sizes[PAYLOADS]
    rows = max(n_past, 1)
    geometry, a = cut(floats, 0, (n, 5))
    inertial, a = cut(floats, a, (n, 10))
    friction, a = cut(floats, a, (n, 3))
    gravity, a = cut(floats, a, (3,))
    drag, a = cut(floats, a, (n,))
    hang, a = cut(floats, a, (n, 4))
    zero_R, a = cut(floats, a, (n, 3, 3))
    zero_p, a = cut(floats, a, (n, 3))
    law, a = cut(floats, a, (3, n))
    drive, a = cut(floats, a, (rows, n))
    parameters, a = cut(floats, a, (n_effect, MOST_PARAMETERS))
    numbers, a = cut(floats, a, (8, n))
    payload, a = cut(floats, a, (n_payload, 2))
    R, a = cut(floats, a, (n, 3, 3))
    p, a = cut(floats, a, (n, 3))
    motion, a = cut(floats, a, (n, 3, 3))
    zero, a = cut(floats, a, (n + 6,))
    A, a = cut(floats, a, (n, n))
    M, a = cut(floats, a, (n, n))
    net, a = cut(floats, a, (n,))
    bias, a = cut(floats, a, (n,))
    now, a = cut(floats, a, (n,))
    slip, a = cut(floats, a, (n,))
    hold, a = cut(floats, a, (n,))
    seen, a = cut(floats, a, (N_STATE,))
    branch, a = cut(floats, a, (n, 10))
    way, a = cut(floats, a, (N_ROW, n))
    past, a = cut(floats, a, (n_past, 2, n))
    state, a = cut(floats, a, (3, n))
    slopes, a = cut(floats, a, (2, 4, n))
    after, a = cut(floats, a, (3, n))
    clock, a = cut(floats, a, (2,))
    path, a = cut(floats, a, (2, 3))
    speed, a = cut(floats, a, (2, 3))
    felt, a = cut(floats, a, (2, 3))
    sent, a = cut(floats, a, (2, 3))
    frame, a = cut(floats, a, (3, 3))
    axes, a = cut(floats, a, (3, 3))
    moving, a = cut(floats, a, (3, 3))
    work, a = cut(floats, a, (2, 3, 3))
    point, a = cut(floats, a, (3,))
    twist, a = cut(floats, a, (3,))
    span, a = cut(floats, a, (3,))
    wall, a = cut(floats, a, (4,))
    coupling, a = cut(floats, a, (N_NUMBER,))
    account, _ = cut(floats, a, (N_ACCOUNT,))
    touched, a = cut(whole, 0, (1,))
    counts, a = cut(whole, a, (2,))
    joint, a = cut(whole, a, (n_effect,))
    address, a = cut(whole, a, (n_effect,))
    parent, _ = cut(whole, a, (n,))
    revolute, a = cut(flags, 0, (n,))
    directed, a = cut(flags, a, (n,))
    slipping, a = cut(flags, a, (n,))
    k = drive.shape[0] - 1
    return Parts(
        Chain(revolute, geometry, inertial, friction, gravity, drag, parent, hang, zero_R, zero_p),
        Commands(law, counts[1] != 0, drive, clock[1], clock[0] - k * clock[1]),
        EffectTable(joint, address, parameters, directed, numbers, flags[a], flags[a + 1], payload),
        Room(R, p, motion, zero, A, M, net, bias, now, slip, hold, slipping, seen, branch, Way(way, past)),
        Touch(
            touched,
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
        ),  # fmt: skip
        state,
        slopes,
        after,
        clock,
        counts,
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
        size = (97 + N_ROW) * n + 2 * n * n + (max(n_past, 1) + 2 * n_past) * n
        size += MOST_PARAMETERS * n_effect + 2 * n_payload + N_STATE + N_NUMBER + N_ACCOUNT + 93
        self.arrays = (
            np.zeros(size),
            np.zeros(3 + 2 * n_effect + n, dtype=np.int64),
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
