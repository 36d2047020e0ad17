"""What a joint's rest says of a push: what static friction cannot hold does not act while the joint rests."""

import numpy as np
from numpy.typing import NDArray

from fitter.diagnosis.least_squares import NEGLIGIBLE
from fitter.diagnosis.torque.background import Rows


def excludes(rows: Rows, torque_N_m: float, part: float = 1.0 - NEGLIGIBLE) -> NDArray[np.bool_]:
    """Say which rows, (n,), exclude a push of some torque: the joint rests for more than a part of the row.

    What holds a joint may differ by twice its friction, from either limit to the other.
    """
    return np.asarray((rows.turning > part) & (2.0 * rows.friction < abs(torque_N_m)), dtype=np.bool_)


def outside(rows: Rows, start_s: float, duration_s: float, torque_N_m: float) -> tuple[float, float]:
    """Return start and duration [s] of a push without the parts of it at its ends in which the joint rests.

    Unchanged if it would be over.
    """
    ends_s, half_s = start_s + duration_s, 0.5 * rows.step_s
    acts = ~excludes(rows, torque_N_m, 0.5) & (rows.t > start_s - half_s) & (rows.t < ends_s + half_s)
    if not acts.any():
        return start_s, duration_s
    first, last = float(rows.t[acts][0]) - half_s, float(rows.t[acts][-1]) + half_s
    begin_s, end_s = max(start_s, first), min(ends_s, last)
    return (begin_s, end_s - begin_s) if end_s > begin_s else (start_s, duration_s)


def unseen_s(rows: Rows, at_s: float, way: int, torque_N_m: float) -> float:
    """Return for how long before (-1) or after (1) an instant nothing tells whether a push acts.

    It is 0 if its row is known and the next.
    """
    k = int(np.clip(np.searchsorted(rows.t, at_s + 0.5 * rows.step_s) - 1, 0, len(rows.t) - 1))
    tells = rows.known | excludes(rows, torque_N_m)
    known = tells[: k + 1][::-1] if way < 0 else tells[k:]
    if np.all(known[:2]):
        return 0.0
    first = int(np.argmin(known))
    return rows.step_s * (first + int(np.argmax(np.append(known[first:], True))))
