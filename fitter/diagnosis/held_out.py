r"""Trials held back: what models get wrong on them, and whether they ask something new of the arm.

What a motion asks is the second moments of its regressor, a sample. Of these matrices A, of it, and B, of others,
the generalized eigenvalues are by how much more it tells of a combination of parameters than they do, whatever the
units and the base parameters (Förstner and Moonen 1999). What is new in it counts, and not what it lacks:

.. math:: d(A, B) = \sqrt{\sum_i \max(\log \lambda_i(A, B), 0)^2 / n}

It is held against what is new in each of the learning motions beside the other ones.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from arm.model import Arm, Floats
from fitter.diagnosis.judgement import Errors, judged
from fitter.diagnosis.least_squares import ROUNDED
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from limbcal.note import Note

#: A fitted model, and the arm that it is, to be simulated.
Fitted = tuple[Candidate, Arm]


@dataclass(frozen=True)
class Judged:
    """What the base and the final model get wrong on trials that had no say in anything.

    Attributes
    ----------
    sets, trials : sequence of str
        Of every trial, the set that it is of, and its name.
    before, after : Errors
    """

    sets: Sequence[str]
    trials: Sequence[str]
    before: Errors
    after: Errors

    def by_set(self) -> dict[str, tuple[Errors, Errors]]:
        """Return the errors before and after of every set."""
        places: dict[str, list[int]] = {}
        for k, name in enumerate(self.sets):
            places.setdefault(name, []).append(k)
        return {name: (self.before.only(some), self.after.only(some)) for name, some in places.items()}

    def by_trial(self) -> dict[str, tuple[Errors, Errors]]:
        """Return the errors before and after of every trial; trials of one name are told apart by their sets."""
        names = [
            f"{one}/{name}" if count > 1 else name
            for one, name, count in zip(
                self.sets, self.trials, map(Counter(self.trials).__getitem__, self.trials), strict=True
            )
        ]
        same = Counter[str]()
        parted = {}
        for k, name in enumerate(names):
            same[name] += 1
            own = name if same[name] == 1 else f"{name} ({same[name]})"
            parted[own] = self.before.only([k]), self.after.only([k])
        return parted

    def document(self) -> dict[str, object]:
        """Return it as JSON has it."""
        return {
            when: {
                **errors.document(),
                "sets": {name: both[k].document() for name, both in self.by_set().items()},
                "trials": {name: both[k].document() for name, both in self.by_trial().items()},
            }
            for k, (when, errors) in enumerate((("before", self.before), ("after", self.after)))
        }


def judged_sets(
    regression: Regression,
    models: tuple[Fitted, Fitted],
    motions: Sequence[Motion],
    sets: Sequence[str],
    horizon_s: float,
) -> Judged:
    """Return what two models get wrong on trials that had no say in anything.

    Parameters
    ----------
    regression : Regression
    models : (before, after)
        Each with its arm.
    motions : sequence of Motion
        Not thinned, under numbers that no other trial of the run has.
    sets : sequence of str
        The set that each of them is of.
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    """
    (base, base_arm), (final, arm) = models
    before = judged(regression, base, base_arm, motions, horizon_s)
    after = before if final is base else judged(regression, final, arm, motions, horizon_s)
    return Judged(sets, [motion.trial.name for motion in motions], before, after)


def likeness(regression: Regression) -> Note | None:
    """Return a note if no more is new in the evaluating motions than in the learning ones, by their medians."""
    rows = {motion.number: regression.rows(Model(), motion).design for motion in regression.motions}
    learnt, held_back = (
        [rows[motion.number] for motion in regression.motions if motion.learn is learn] for learn in (True, False)
    )
    if not learnt or not held_back:
        return None
    parts = learnt if len(learnt) > 1 else np.array_split(learnt[0], 2)
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
    kept = values > np.sqrt(ROUNDED) * values[-1]
    root = axes[:, kept] / np.sqrt(values[kept])
    least = np.sqrt(ROUNDED) * np.eye(root.shape[1])
    ratios = scipy.linalg.eigh(root.T @ A @ root + least, root.T @ B @ root + least, eigvals_only=True)
    return float(np.sqrt(np.mean(np.log(np.maximum(ratios, 1.0)) ** 2)))
