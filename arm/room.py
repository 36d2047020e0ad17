"""Arrays that a simulation works in, made once."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.drive import N_ROW, SHARE, Way
from arm.effects.joint_torque import N_STATE
from arm.model import Floats
from limbcal.compiled import compiled


class Room(NamedTuple):
    """Poses and motion of the links, the equations of motion, friction as it is now, and the torque's way."""

    R: Floats
    p: Floats
    motion: Floats
    zero: Floats
    A: Floats
    M: Floats
    net: Floats
    bias: Floats
    now: Floats
    slip: Floats
    hold: Floats
    directed: NDArray[np.bool_]
    seen: Floats
    branch: Floats
    way: Way


@compiled
def make_room(n: int, n_past: int) -> Room:
    """Return the working arrays for ``n`` joints and ``n_past`` steps whose commands are kept."""
    way = Way(np.zeros((N_ROW, n)), np.zeros((n_past, 2, n)))
    way.state[SHARE] = 1.0
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
        np.empty(n),
        np.empty(n),
        np.empty(n, dtype=np.bool_),
        np.empty(N_STATE),
        np.zeros((n, 10)),
        way,
    )
