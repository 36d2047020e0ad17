"""Fits of disjoint trials by themselves: what they disagree by is what one of them does not know.

A trial that does not move what the whole recording determines, such as a static one, would return the prior
and counts for nothing here. Where fewer than two trials are left, the halves of the most informative one stand in.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from arm.marker_kinematics import Integers
from arm.model import Floats
from fitter.limb.bundle import Bundle, Task, fit_bundle
from fitter.limb.uncertainty import LEARNT

#: Frames of a part at the least, and iterations from the answer of the whole at the most.
_LEAST_FRAMES, _MOST_ITERATIONS = 10, 25


def disjoint_fits(
    task: Task, bundle: Bundle, trial: Integers, progress: Callable[[str, int], None] | None = None
) -> list[Bundle]:
    """Return the fits of trials, or halves of one, that determine alone what all determine together.

    Parameters
    ----------
    task : Task
    bundle : Bundle
        Of all frames.
    trial : (n_frame,) int64
        Which trial each frame is of, from 0; halves of the only one.
    progress : callable, optional
        Called with what is being done, and the iteration.
    """

    def fitted(rows: Integers, what: str) -> Bundle:
        report = None if progress is None else lambda iteration: progress(what, iteration)
        own, start = task.rows(rows), bundle
        return fit_bundle(
            own, start.geometry, start.markers, start.q[rows], report, _MOST_ITERATIONS, scales_known=True
        )

    wanted = learnt(task, bundle)
    parts = [np.flatnonzero(trial == one) for one in np.unique(trial)]
    parts = [rows for rows in parts if len(rows) >= _LEAST_FRAMES]
    found = [fitted(rows, f"trial {k + 1} by itself") for k, rows in enumerate(parts)]
    telling = [one for one in found if learnt(task, one)[wanted].all()]
    if len(telling) >= 2 or not found:
        return telling
    best = int(np.argmin([_std(task, one)[wanted].sum() for one in found]))
    middle = len(parts[best]) // 2
    if middle < _LEAST_FRAMES:
        return []
    halves = (parts[best][:middle], parts[best][middle:])
    return [fitted(rows, f"half {k + 1} by itself") for k, rows in enumerate(halves)]


def learnt(task: Task, bundle: Bundle) -> NDArray[np.bool_]:
    """Return which free parameters a fit determines beyond their prior, (n_free,)."""
    return np.asarray(_std(task, bundle) < LEARNT * task.free.std)


def _std(task: Task, bundle: Bundle) -> Floats:
    posterior = np.linalg.inv(bundle.S.sum(axis=0) + np.diag(task.prior.information))
    return np.asarray(np.sqrt(np.diag(posterior)[: len(task.free.std)]))
