"""Angles that leap by a whole turn at the end of their range: unwrapped before anything else."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import turning
from limbcal.note import Note

_TURN = 2.0 * np.pi
#: A step is a leap by a turn if what the turn leaves of it is within this share of a turn: a quarter. With fewer
#: than four samples a turn, nobody can say which way a joint went.
_NEAR = 0.25


def look(motion: Measured, arm: Arm) -> Measured:
    """Return the motion with turns taken out of its angles, and with its target put beside them."""
    if "q" not in motion.columns or len(motion.t) < 3:
        return motion
    columns, notes = dict(motion.columns), []
    q, turns = columns["q"].copy(), turning(arm)
    spoilt = False
    for j in np.flatnonzero(turns).tolist():
        leaps = leaps_of(q[:, j])
        at = np.flatnonzero(leaps)
        if not at.size:
            continue
        q[1:, j] -= _TURN * np.cumsum(leaps)
        said = f"q{j + 1} leaps by a turn {len(at)} time(s): unwrapped"
        if "ref" in columns:
            ref = columns["ref"].copy()
            ref[:, j] += _TURN * np.round((q[:, j] - ref[:, j]) / _TURN)
            columns["ref"] = ref
        for role in ("dq", "ddq"):
            if role in columns and _spoilt(motion.t, columns[role][:, j], at):
                spoilt = True
        row = motion.first_row + int(at[0]) + 2
        notes.append(Note("turn", said, columns=(f"q{j + 1}",), row=row, from_s=float(motion.t[at[0] + 1])))
    if not notes:
        return motion
    columns["q"] = q
    if spoilt:
        for role in ("dq", "ddq"):
            columns.pop(role, None)
        notes.append(Note("turn", "dq and ddq were derived across the leaps: derived anew", columns=("dq", "ddq")))
    return replace(motion, columns=columns, notes=(*motion.notes, *notes))


def leaps_of(angle: Floats) -> NDArray[np.float64]:
    """Return the whole turns by which an angle leaps from each sample to the next, (n − 1,).

    A wheel so fast that it really turns that far between two samples does so steadily: its neighbouring steps are
    as long, and nothing leaps.
    """
    steps = np.diff(angle)
    turns = np.round(steps / _TURN)
    left = np.abs(steps - _TURN * turns)
    padded = np.abs(np.concatenate([steps[1:2], steps, steps[-2:-1]]))
    beside = np.minimum(padded[:-2], padded[2:])
    leaps = (left < _NEAR * _TURN) & (beside < _NEAR * np.abs(steps))
    return np.asarray(np.where(leaps, turns, 0.0), dtype=np.float64)


def _spoilt(t: Floats, rate: Floats, at: NDArray[np.intp]) -> bool:
    """Say whether a derivative shows the leap itself: a spike of a good part of a turn within a few samples."""
    step = float(np.median(np.diff(t)))
    beside = np.abs(rate[np.clip(np.concatenate([at - 1, at, at + 1, at + 2]), 0, len(rate) - 1)])
    return bool(beside.max() * step > 0.1 * _TURN and beside.max() > 10.0 * np.median(np.abs(rate)))
