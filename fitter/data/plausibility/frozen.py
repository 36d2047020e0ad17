"""An angle that stands still while its joint moves on: an encoder or its line that froze.

A joint at rest differs by how gently it stops and goes on, not by its speed (`fitter.data.standstill`);
rows that repeat amid a motion, of a logger that is too fast, are `repeats`'.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.motions import Measured
from limbcal.note import Note

#: Least number of samples, the same to the last bit, of an angle that has frozen …
_STANDS = 5
#: … and least steps into or out of them, as a fraction of the joint's longest usual step (a joint that friction
#: stops slows down first) and in steps of the encoder.
_ABRUPT, _COUNTS = 0.2, 5.0
#: A joint that stood still speeds up evenly: its first step is no longer than the next, let alone by this factor.
_LEAP = 3.0
#: Fraction of a joint's usual top speed from which no drive stops it within a sample, to the last bit.
_FROM_SPEED = 0.5


def look(motion: Measured, _arm: Arm) -> Measured:
    """Return the motion without the rows in which an angle is frozen; a joint that never moves is noted."""
    q = motion.columns.get("q")
    if q is None or len(q) < 4 * _STANDS:
        return motion
    gone = np.zeros(len(q), dtype=bool)
    notes = []
    moves = np.ptp(q, axis=0) > 0.0
    for j in range(q.shape[1]):
        if not moves[j]:
            notes += _never(motion, j, moves)
            continue
        frozen = frozen_rows(q[:, j])
        if frozen.any():
            at = np.flatnonzero(frozen)
            said = (
                f"q{j + 1} stands still in {len(at)} of {len(q)} samples and leaps on: did its encoder freeze? "
                "Those rows are left out"
            )
            row = motion.first_row + int(at[0]) + 1
            notes.append(Note("frozen", said, columns=(f"q{j + 1}",), row=row, from_s=float(motion.t[at[0]])))
            gone |= frozen
    if not notes:
        return motion
    if gone.mean() > 0.5 or not gone.any():
        return replace(motion, notes=(*motion.notes, *notes))
    return replace(
        motion,
        t=motion.t[~gone],
        columns={role: values[~gone] for role, values in motion.columns.items()},
        labels=None if motion.labels is None else motion.labels[~gone],
        notes=(*motion.notes, *notes),
    )


def frozen_rows(q: Floats) -> NDArray[np.bool_]:
    """Return which samples of an angle repeat the last one although the joint moves, (n,)."""
    change = np.diff(q)
    steps = np.abs(change)
    moving = steps[steps > 0.0]
    marked = np.zeros(len(q), dtype=bool)
    if len(moving) < _STANDS:
        return marked
    usual = float(np.quantile(moving, 0.9))
    abrupt = max(_ABRUPT * usual, _COUNTS * float(moving.min()))
    bounds = [*(np.flatnonzero(steps > 0.0) + 1).tolist(), len(q)]  # nobody saw how the first readings came
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        if end - begin <= _STANDS:
            continue
        stops = steps[begin - 1] > abrupt
        leaps = end < len(q) - 1 and steps[end - 1] > max(abrupt, _LEAP * steps[end])
        # A joint that turns is slow anyway; an encoder whose counts are interpolated then stays, and steps back.
        turns = end < len(q) and change[begin - 1] * change[end - 1] < 0.0 and steps[end - 1] <= usual
        goes_on = end == len(q) or steps[end - 1] > abrupt
        if (leaps and not turns) or (stops and goes_on) or steps[begin - 1] > _FROM_SPEED / _ABRUPT * abrupt:
            marked[begin + 1 : end] = True
    return marked


def _never(motion: Measured, j: int, moves: NDArray[np.bool_]) -> list[Note]:
    """Return a note where a joint never moves to the last bit although its torque works and others move."""
    tau = motion.columns.get("tau")
    if tau is None or not moves.any() or not np.ptp(tau[:, j]) > 0.0:
        return []
    said = (
        f"q{j + 1} is {motion.columns['q'][0, j]:.4g} in all {len(motion.t)} samples while tau{j + 1} works "
        f"between {tau[:, j].min():.3g} and {tau[:, j].max():.3g}: is its encoder read at all, or is the joint "
        "locked? Nothing is learnt of it"
    )
    return [Note("frozen", said, columns=(f"q{j + 1}",), row=motion.first_row + 1, from_s=float(motion.t[0]))]
