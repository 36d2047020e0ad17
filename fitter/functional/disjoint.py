"""Disjoint parts of a recording, and what their disagreement says of an answer.

Skin moves coherently over seconds, so the frames' residuals are not independent and an error that is computed as
if they were is several times too small. What is left out instead is a whole part at a time: the jackknife over
parts (Efron and Stein 1981; over clusters MacKinnon, Nielsen and Webb 2023) needs no model of how frames hang
together within a part. A trial is never split between a part and another where there are trials enough.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Floats

#: Parts that a jackknife needs at the least for its own error to be small: with six, five degrees of freedom, the
#: 95 % interval is 1.3 times as wide as with many (Student's t 2.57 against 1.96).
LEAST_PARTS = 6
#: Frames of a part at the least; the three of a frame's coordinates are then far more than the unknowns.
_LEAST_FRAMES = 5


@dataclass(frozen=True)
class Parts:
    """Which disjoint part a frame belongs to, -1 for none.

    Attributes
    ----------
    part : (n_frame,) int
        Numbered from 0, for the standard errors.
    trial : (n_frame,) int
        Numbered from 0, for the disagreement of trials; halves where there is one trial only.
    """

    part: NDArray[np.intp]
    trial: NDArray[np.intp]

    @property
    def n_part(self) -> int:
        """How many parts there are."""
        return int(self.part.max(initial=-1)) + 1

    @property
    def n_trial(self) -> int:
        """How many trials, or halves, there are."""
        return int(self.trial.max(initial=-1)) + 1


def disjoint_parts(usable: Sequence[NDArray[np.bool_]]) -> Parts:
    """Cut trials into parts with alike many usable frames.

    Parameters
    ----------
    usable : sequence of (n_frame,) bool
        Of each trial, in the order of the frames.
    """
    counts = [int(np.count_nonzero(frames)) for frames in usable]
    n_trial = sum(count >= 2 * _LEAST_FRAMES for count in counts)
    pieces = -(-LEAST_PARTS // n_trial) if n_trial else 1
    part, trial = [], []
    n_part = n_group = 0
    for frames, count in zip(usable, counts, strict=True):
        rank = np.cumsum(frames) - 1
        cut = max(1, min(pieces, count // _LEAST_FRAMES))
        halves = 2 if n_trial == 1 and count >= 2 * _LEAST_FRAMES else 1
        enough = frames if count >= _LEAST_FRAMES else np.zeros_like(frames)
        part.append(np.where(enough, n_part + rank * cut // max(count, 1), -1))
        trial.append(np.where(enough, n_group + rank * halves // max(count, 1), -1))
        n_part += cut if enough.any() else 0
        n_group += halves if enough.any() else 0
    return Parts(np.concatenate(part).astype(np.intp), np.concatenate(trial).astype(np.intp))


def jackknife(answer: Callable[[NDArray[np.bool_]], Floats], n_part: int) -> Floats:
    """Return the covariance of an answer, (n, n), from leaving out one part at a time; NaN for fewer than two.

    Parameters
    ----------
    answer : callable
        Given which parts to use, (n_part,) bool, returns (n,).
    n_part : int
    """
    everything = np.ones(n_part, dtype=bool)
    whole = answer(everything)
    if n_part < 2:
        return np.full((len(whole), len(whole)), np.nan)
    without = np.array([answer(np.arange(n_part) != i) for i in range(n_part)])
    away = without - whole
    return np.asarray((n_part - 1) / n_part * away.T @ away)


def coverage_factor(n_part: int, probability: float = 0.95) -> float:
    """Return how many standard deviations make an interval: Student's t, one degree of freedom below the parts."""
    return float(scipy.stats.t.ppf(0.5 + probability / 2.0, n_part - 1)) if n_part > 1 else np.nan


def rms_apart(answers: Sequence[Floats]) -> float:
    """Return the root mean square distance between pairs of answers, (n,) each; NaN for fewer than two."""
    points = np.array(answers)
    if len(points) < 2:
        return np.nan
    first, second = np.triu_indices(len(points), 1)
    return float(np.sqrt(np.mean(np.sum((points[first] - points[second]) ** 2, axis=1))))
