r"""Whether motions held back differ in kind from those that were learnt from.

Motions are alike if they ask the same of the arm: the second moments of their regressors, a sample, are alike.
These matrices are apart by a distance that no choice of units or of base parameters changes (Förstner and Moonen
1999):

.. math:: d(A, B) = \sqrt{\sum_i \log^2 \lambda_i(A, B) / n}

with their n generalized eigenvalues: the rms of the logarithm by which one tells more of a combination of
parameters than the other. It is held against what the learning motions are apart from each other.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from limbcal.note import Note

#: A combination of which a motion tells less than this share of what all do is not told: the rest is rounding.
_UNTOLD = 1e-6
#: A single learning motion is held against itself in so many parts.
_PARTS = 2


def likeness(regression: Regression) -> Note | None:
    """Return a note if the evaluating motions are no farther from the learning ones than these from each other.

    By the medians over motions.
    """
    rows = {motion.number: regression.rows(Model(), motion).design for motion in regression.motions}
    learnt, held_back = (
        [rows[motion.number] for motion in regression.motions if motion.learn is learn] for learn in (True, False)
    )
    if not learnt or not held_back:
        return None
    parts = learnt if len(learnt) > 1 else np.array_split(learnt[0], _PARTS)
    own = np.median([apart([one], [*parts[:k], *parts[k + 1 :]]) for k, one in enumerate(parts)])
    others = np.median([apart([one], learnt) for one in held_back])
    if others > own:
        return None
    return Note(
        "alike",
        "the evaluating motions are like the learning ones: the second moments of their regressors are apart by "
        f"{np.exp(others):.3g} times, those of the learning motions by {np.exp(own):.3g} times; how motions of "
        "another kind are predicted, this data does not show",
    )


def apart(some: Sequence[Floats], others: Sequence[Floats]) -> float:
    """Return the distance of the second moments of two sets of rows (n_row, n_column) each."""
    A, B = (np.sum([one.T @ one for one in rows], axis=0) / sum(map(len, rows)) for rows in (some, others))
    size = np.sqrt(np.diag(A) + np.diag(B))
    told = size > 0.0
    A, B = (moments[np.ix_(told, told)] / np.outer(size[told], size[told]) for moments in (A, B))
    values, axes = np.linalg.eigh(A + B)
    kept = values > _UNTOLD * values[-1]
    root = axes[:, kept] / np.sqrt(values[kept])
    least = _UNTOLD * np.eye(root.shape[1])
    ratios = scipy.linalg.eigh(root.T @ A @ root + least, root.T @ B @ root + least, eigvals_only=True)
    return float(np.sqrt(np.mean(np.log(ratios) ** 2)))
