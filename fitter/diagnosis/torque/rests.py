"""What a joint's rest says of a push: what static friction cannot hold does not act while the joint rests."""

import numpy as np
from numpy.typing import NDArray

from fitter.diagnosis.least_squares import SIGMAS
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows


def excludes(rows: Rows, torque_N_m: float) -> NDArray[np.bool_]:
    """Say which rows, (n,), exclude a push of some torque: the joint rests for most of it, held by its friction.

    Where more is missed than that holds, but for noise, the joint may already move, unseen. With a push what holds
    a joint may differ by twice its friction, from either limit to the other.
    """
    # The angle's noise is differentiated twice: eq. (m.1).
    noise = np.hypot(rows.torque_noise, np.sqrt(6.0) * rows.angle_noise / rows.step_s**2)
    is_held = np.abs(rows.held) <= rows.friction + SIGMAS * noise
    rests = rows.turning > 0.5
    return np.asarray(rests & is_held & (2.0 * rows.friction < abs(torque_N_m)), dtype=np.bool_)


def outside(rows: Rows, start_s: float, duration_s: float, torque_N_m: float) -> tuple[float, float]:
    """Return start and duration [s] of a push without the parts of it at its ends in which the joint rests.

    Unchanged if it would be over.
    """
    ends_s, half_s = start_s + duration_s, 0.5 * rows.step_s
    acts = ~excludes(rows, torque_N_m) & (rows.t > start_s - half_s) & (rows.t < ends_s + half_s)
    if not acts.any():
        return start_s, duration_s
    first, last = float(rows.t[acts][0]) - half_s, float(rows.t[acts][-1]) + half_s
    begin_s, end_s = max(start_s, first), min(ends_s, last)
    return (begin_s, end_s - begin_s) if end_s > begin_s else (start_s, duration_s)


def unseen(rows: Rows, at_s: float, way: int, torque_N_m: float) -> tuple[float, float]:
    """Return from when to when [s] nothing tells whether a push acts, about its start (-1) or its end (1).

    Both are that instant if its row tells and the one beside it.
    """
    k = int(np.clip(np.searchsorted(rows.t, at_s + 0.5 * rows.step_s) - 1, 0, len(rows.t) - 1))
    tells = np.concatenate([[True], rows.known | excludes(rows, torque_N_m), [True]])
    near = k + 1 if not tells[k + 1] else k + 1 + way
    if tells[near]:
        return at_s, at_s
    last, next_ = near - int(np.argmax(tells[near::-1])), near + int(np.argmax(tells[near:]))
    half_s = 0.5 * rows.step_s
    return float(rows.t[last]) - half_s, float(rows.t[next_ - 2]) + half_s


def amid(rows: Rows, start_s: float, duration_s: float, torque_N_m: float) -> tuple[float, float, float, float]:
    """Return start and duration [s] of a push whose ends are amid what is unseen of each, and how long that lasts.

    Unchanged if it would be over.
    """
    ends_s = start_s + duration_s
    first, last = unseen(rows, start_s, -1, torque_N_m), unseen(rows, ends_s, 1, torque_N_m)
    # What lasts longer is no pulse.
    first = min(max(first[0], ends_s - LONGEST_PULSE_S), first[1]), first[1]
    last = last[0], max(min(last[1], start_s + LONGEST_PULSE_S), last[0])
    begin_s, end_s = 0.5 * sum(first), 0.5 * sum(last)
    if end_s > begin_s:
        start_s, duration_s = begin_s, end_s - begin_s
    return start_s, duration_s, first[1] - first[0], last[1] - last[0]
