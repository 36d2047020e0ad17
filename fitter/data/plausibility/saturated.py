"""A torque that stands at its limit: what was cut off says nothing of the arm."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.motions import Measured
from limbcal.note import Note

#: The role of the column that says which torques do not count, 1 where they don't.
CONTRADICTED = "contradicted"
#: Least number of neighbouring samples equal to a torque's extreme where it is at a limit. A smooth peak that is
#: rounded to the sensor's resolution enters it by steps of one resolution, a cut-off one by longer ones.
_STANDS = 5
_STEPS = 3.0
#: Fraction of samples that must remain, and that may stand at other levels: beyond it the torque is made of steps.
_LEFT = 0.1


def look(motion: Measured, _arm: Arm) -> Measured:
    """Return the motion with torques marked that were cut off."""
    tau = motion.columns.get("tau")
    if tau is None or len(tau) < 2 * _STANDS:
        return motion
    marked = np.zeros(tau.shape, dtype=bool)
    notes = []
    for j in range(tau.shape[1]):
        cut = cut_off(tau[:, j])
        if not cut.any():
            continue
        at = np.flatnonzero(cut)
        levels = np.unique(tau[at, j])
        symmetric = len(levels) == 2 and np.isclose(levels[0], -levels[1], rtol=1e-3)
        level = f"±{levels[-1]:.4g}" if symmetric else " and ".join(f"{x:.4g}" for x in levels)
        said = f"tau{j + 1} stands at {level} in {len(at)} of {len(tau)} samples: cut off? They do not count"
        row = motion.first_row + int(at[0]) + 1
        notes.append(Note("saturated", said, columns=(f"tau{j + 1}",), row=row, from_s=float(motion.t[at[0]])))
        marked[:, j] = cut
    if not notes:
        return motion
    columns = {**motion.columns, CONTRADICTED: marked.astype(np.float64)}
    return replace(motion, columns=columns, notes=(*motion.notes, *notes))


def cut_off(tau: Floats) -> NDArray[np.bool_]:
    """Return which samples of a torque stand at its limit, (n,)."""
    steps = np.abs(np.diff(tau))
    nothing = np.zeros(len(tau), dtype=bool)
    if not np.any(steps > 0.0):
        return nothing
    resolution = float(steps[steps > 0.0].min())
    marked = nothing.copy()
    runs = [run for run in _runs(tau) if run[1] - run[0] >= _STANDS]
    extremes = (float(tau.max()), float(tau.min()))
    elsewhere = sum(end - begin for begin, end in runs if tau[begin] not in extremes)
    for begin, end in runs:
        if tau[begin] not in extremes or tau[begin] == 0.0:
            continue
        into = abs(tau[begin] - tau[begin - 1]) if begin else 0.0
        out_of = abs(tau[end] - tau[end - 1]) if end < len(tau) else 0.0
        if max(into, out_of) > _STEPS * resolution:
            marked[begin:end] = True
    made_of_steps = elsewhere > marked.sum() or np.mean(~marked) < _LEFT
    return nothing if made_of_steps else marked


def _runs(values: Floats) -> list[tuple[int, int]]:
    """Return where stretches of equal values begin and end."""
    bounds = [0, *(np.flatnonzero(np.diff(values) != 0.0) + 1).tolist(), len(values)]
    return list(zip(bounds[:-1], bounds[1:], strict=True))
