"""Where a tracker knows an angle no more: after lost samples it goes on as predicted, and says how badly.

Of the variance that a tracker claims, what it claimed before samples were lost is an error of the whole motion.
What has come on top since is an error of the frames that follow. Where that has more than a tenth of the motion's
own power, an angle and its derivatives are a guess, and torques that are computed or compared there say nothing of
the arm.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fitter.data.bandwidth import SIGNAL_TO_NOISE
from fitter.data.motions import Measured
from fitter.data.plausibility.saturated import CONTRADICTED
from limbcal.note import Note


def with_uncertain_marked(motion: Measured, lost: NDArray[np.bool_]) -> Measured:
    """Return a motion with the samples marked, joint by joint, at which its tracker knew an angle no more.

    Parameters
    ----------
    motion : Measured
        Unchanged where it has no ``q_std``, or lost nothing that matters.
    lost : (n,) bool
        Frames of blocks in which, or before which, samples were lost.
    """
    std = motion.columns.get("q_std")
    if std is None or not lost.any():
        return motion
    first = int(np.argmax(lost))
    grown = std**2 - np.min(std[: first + 1], axis=0) ** 2
    uncertain = SIGNAL_TO_NOISE * grown > np.var(motion.columns["q"], axis=0)
    uncertain[:first] = False
    notes = []
    for j in np.flatnonzero(uncertain.any(axis=0)).tolist():
        rows = np.flatnonzero(uncertain[:, j])
        begin_s, end_s = (float(motion.t[k]) for k in (rows[0], rows[-1]))
        text = (
            f"q{j + 1} is known to no better than {float(std[rows, j].max()):.2g} rad or m in {len(rows)} of "
            f"{len(std)} frames after lost samples: no fit of dynamics counts joint {j + 1} there"
        )
        notes.append(Note("uncertain", text, columns=(f"q{j + 1}",), from_s=begin_s, to_s=end_s))
    if not notes:
        return motion
    columns = {**motion.columns, CONTRADICTED: uncertain.astype(np.float64)}
    return replace(motion, columns=columns, notes=(*motion.notes, *notes))
