"""Rows that repeat the one before amid a motion: a logger faster than what it logs, or one that stalls."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.motions import Measured
from limbcal.note import Note

#: Least steps on both sides of a row repeated in a motion, as a fraction of the joint's usual longest.
_MOVING = 0.1
#: Columns that the outside world gives: a repeated row repeats all of them to the last bit.
_MEASURED = ("q", "dq", "ddq", "tau", "tip")
#: Fewer repeated rows than this may be chance.
_FEW = 3


def look(motion: Measured, _arm: Arm) -> Measured:
    """Return the motion without rows that repeat the one before."""
    q = motion.columns.get("q")
    if q is None or len(q) < 8:
        return motion
    repeated = repeated_rows(np.hstack([motion.columns[role] for role in _MEASURED if role in motion.columns]), q)
    n = int(repeated.sum())
    if n < _FEW:
        return motion
    at = int(np.flatnonzero(repeated)[0])
    said = (
        f"{n} of {len(q)} rows repeat the row before in the middle of a motion: the logger was faster than what "
        "it logged, or stalled; they are left out"
    )
    note = Note("repeated", said, row=motion.first_row + at + 1, from_s=float(motion.t[at]))
    kept = ~repeated
    return replace(
        motion,
        t=motion.t[kept],
        columns={role: values[kept] for role, values in motion.columns.items()},
        labels=None if motion.labels is None else motion.labels[kept],
        notes=(*motion.notes, note),
    )


def repeated_rows(rows: Floats, q: Floats) -> NDArray[np.bool_]:
    """Return which rows repeat the one before while some joint moves, (n,).

    Parameters
    ----------
    rows : ndarray of shape (n, k)
        All that was measured.
    q : ndarray of shape (n, n_joint)
        Angles. Where the resolution of an encoder is no smaller than its usual step, nothing is said.
    """
    same = np.concatenate([np.zeros(1, dtype=bool), np.asarray(np.all(rows[1:] == rows[:-1], axis=1))])
    if not same.any():
        return same
    steps = np.abs(np.diff(q, axis=0))
    fast = np.zeros(q.shape, dtype=bool)
    for j in range(q.shape[1]):
        moving = steps[:, j][steps[:, j] > 0.0]
        if not len(moving):
            continue
        least = max(_MOVING * float(np.quantile(moving, 0.9)), 3.0 * float(moving.min()))
        fast[1:, j] = steps[:, j] > least
    moves = np.asarray(fast.any(axis=1))
    marked = np.zeros(len(q), dtype=bool)
    bounds = [*(np.flatnonzero(same[1:] != same[:-1]) + 1).tolist(), len(same)]  # the first row repeats none
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        if not same[begin]:
            continue
        if moves[begin - 1] and end < len(same) and moves[end]:
            marked[begin:end] = True
    return marked
