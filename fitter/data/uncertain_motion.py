"""Where a tracker knows a motion no more: after lost samples it goes on as predicted, and says how badly.

Of the variance that a tracker claims, what it claimed before samples were lost is an error of the whole motion.
What has come on top since is an error of the instants that follow. Where that has more than a tenth of the power
of the motion, in an angle or a derivative, the motion is a guess. Each torque depends on the motion of all joints:
torques that are computed or compared there say nothing of the arm.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fitter.data.bandwidth import SIGNAL_TO_NOISE
from fitter.data.motions import Measured
from fitter.data.plausibility.saturated import CONTRADICTED
from limbcal.note import Note

Floats = NDArray[np.float64]

#: The kind of note.
UNCERTAIN = "uncertain"


def with_uncertain_marked(motion: Measured, lost: NDArray[np.bool_], claims: Mapping[str, Floats]) -> Measured:
    """Return a motion with the instants marked at which its tracker knew it no more.

    Parameters
    ----------
    motion : Measured
        Unchanged where it lost nothing that matters.
    lost : (n,) bool
        Frames of blocks in which, or before which, samples were lost.
    claims : mapping of str to (n, n_joint)
        Standard deviations that the tracker claims of columns: of ``q``, and of its derivatives if it does.
    """
    if not lost.any():
        return motion
    first = int(np.argmax(lost))
    uncertain = np.zeros(motion.columns["q"].shape, dtype=bool)
    for name, std in claims.items():
        grown = std**2 - np.min(std[: first + 1], axis=0) ** 2
        uncertain |= SIGNAL_TO_NOISE * grown > np.var(motion.columns[name], axis=0)
    uncertain[:first] = False
    if not uncertain.any():
        return motion
    notes = []
    for j in np.flatnonzero(uncertain.any(axis=0)).tolist():
        rows = np.flatnonzero(uncertain[:, j])
        begin_s, end_s = (float(motion.t[k]) for k in (rows[0], rows[-1]))
        worst = float(claims["q"][rows, j].max())
        text = (
            f"the motion of joint {j + 1} is a guess in {len(rows)} of {len(uncertain)} frames after lost samples "
            f"(q{j + 1} known to {worst:.2g} rad or m at worst): no fit of dynamics counts them"
        )
        notes.append(Note(UNCERTAIN, text, columns=(f"q{j + 1}",), from_s=begin_s, to_s=end_s))
    marked = np.broadcast_to(uncertain.any(axis=1, keepdims=True), uncertain.shape)
    columns = {**motion.columns, CONTRADICTED: marked.astype(np.float64)}
    return replace(motion, columns=columns, notes=(*motion.notes, *notes))
