"""Cells of a joint's motion: where in angle and velocity it is, alike in all trials.

A model's discrepancy mostly depends on the motion: residuals are alike whenever a joint moves alike.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fitter.diagnosis.motion import Motion

#: Parts of equal time into which angle and velocity are cut: 25 cells a joint. A scatter over fewer than some 20
#: groups is too small (Cameron and Miller 2015, VI.A); within larger cells what is lacking is not alike.
N_PART = 5


def cells_of(motions: Sequence[Motion]) -> list[NDArray[np.intp]]:
    """Return the cell of every joint at every sample of each motion, (n_sample, n_joint); joints share none."""
    shares = np.linspace(0.0, 1.0, N_PART + 1)[1:-1]

    def part(values: Sequence[NDArray[np.float64]]) -> list[NDArray[np.intp]]:
        borders = np.quantile(np.concatenate(values), shares, axis=0)
        return [np.sum(one[:, None] > borders, axis=1) for one in values]

    angle, velocity = part([motion.q for motion in motions]), part([motion.dq for motion in motions])
    return [(np.arange(q.shape[1]) * N_PART + q) * N_PART + dq for q, dq in zip(angle, velocity, strict=True)]
