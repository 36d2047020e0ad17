r"""Whether motions held back ask something of the arm that those that were learnt from did not.

What a motion asks is the second moments of its regressor, a sample. Of these matrices A, of it, and B, of others,
the generalized eigenvalues are by how much more it tells of a combination of parameters than they do, whatever the
units and the base parameters (Förstner and Moonen 1999). What is new in it counts, and not what it lacks:

.. math:: d(A, B) = \sqrt{\sum_i \max(\log \lambda_i(A, B), 0)^2 / n}

It is held against what is new in each of the learning motions beside the other ones.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from limbcal.note import Note

#: Eigenvalues below this ratio to the largest are rounding: the combination is not identifiable.
_SINGULAR = 1e-6
#: Parts that a single learning motion is cut into, to compare them with each other.
_PARTS = 2


def likeness(regression: Regression) -> Note | None:
    """Return a note if no more is new in the evaluating motions than in the learning ones, by their medians."""
    rows = {motion.number: regression.rows(Model(), motion).design for motion in regression.motions}
    learnt, held_back = (
        [rows[motion.number] for motion in regression.motions if motion.learn is learn] for learn in (True, False)
    )
    if not learnt or not held_back:
        return None
    parts = learnt if len(learnt) > 1 else np.array_split(learnt[0], _PARTS)
    own = np.median([novelty([one], [*parts[:k], *parts[k + 1 :]]) for k, one in enumerate(parts)])
    others = np.median([novelty([one], learnt) for one in held_back])
    if others > own:
        return None
    return Note(
        "alike",
        "the evaluating motions are like the learning ones: the second moments of their regressors are larger by "
        f"{np.exp(others):.3g} times, those of a learning motion by {np.exp(own):.3g} times than the others'; how "
        "motions of another kind are predicted, this data does not show",
    )


def novelty(some: Sequence[Floats], others: Sequence[Floats]) -> float:
    """Return what is new in some rows, (n_row, n_column) each, beside others."""
    A, B = (np.sum([one.T @ one for one in rows], axis=0) / sum(map(len, rows)) for rows in (some, others))
    size = np.sqrt(np.diag(A) + np.diag(B))
    excited = size > 0.0
    A, B = (moments[np.ix_(excited, excited)] / np.outer(size[excited], size[excited]) for moments in (A, B))
    values, axes = np.linalg.eigh(A + B)
    kept = values > _SINGULAR * values[-1]
    root = axes[:, kept] / np.sqrt(values[kept])
    least = _SINGULAR * np.eye(root.shape[1])
    ratios = scipy.linalg.eigh(root.T @ A @ root + least, root.T @ B @ root + least, eigvals_only=True)
    return float(np.sqrt(np.mean(np.log(np.maximum(ratios, 1.0)) ** 2)))
