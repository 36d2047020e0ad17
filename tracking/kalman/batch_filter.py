"""The live filter in strides: as many frames at once as nothing happens in, the others one at a time."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from tracking.kalman.batch_step import strides
from tracking.kalman.live_filter import LiveFilter


class Course(NamedTuple):
    """What came of readings, frame by frame.

    Attributes
    ----------
    states : (n, 3 * n_joint + n_channel)
        The state's beginning: angles and their derivatives, offsets.
    variances : (n, n_joint)
        Of the angles.
    still, resting : (n,)
        Whether the arm was held to be at rest, and whether it is now known to rest.
    """

    states: Floats
    variances: Floats
    still: NDArray[np.bool_]
    resting: NDArray[np.bool_]


def joined(parts: Sequence[Course]) -> Course:
    """Return what came of readings in parts, one after the other, as one; a single part as it is."""
    return parts[0] if len(parts) == 1 else Course(*map(np.concatenate, zip(*parts, strict=True)))


class BatchFilter(LiveFilter):
    """A live filter that takes in many readings; what it makes of them is what `step` does, bit for bit."""

    def follow(self, readings: Floats) -> Course:
        """Do `step` with each of some readings, (n, n_channel)."""
        n, known = len(readings), 3 * self._n + self._n_channel
        course = Course(np.empty((n, known)), np.empty((n, self._n)), np.empty(n, np.bool_), np.empty(n, np.bool_))
        k = 0
        while k < n:
            taken = self._strides(readings[k:], course, k)
            if not taken:
                course.still[k] = self.step(readings[k])
                course.states[k], course.variances[k] = self.x[:known], self.angle_variance
                taken = 1
            k += taken
            course.resting[k - 1] = self.resting
        return course

    def _strides(self, readings: Floats, course: Course, k: int) -> int:
        """Take in readings while nothing happens; return how many."""
        if not self._begun or self._any_coupled:
            return 0
        kf, (sizes, shares) = self._kf, np.empty((2, len(readings)))
        try:
            count, kf.x, kf.P, self._rest_at, self._still, self.resting, self._in_cell, self._cells = strides(
                self._of,
                kf.F,
                kf.Q,
                kf.x,
                kf.P,
                readings,
                self._rest_at,
                self._still,
                self.resting,
                self._moving_noise,
                self._rest_noise,
                self._limits,
                self._window,
                self._in_cell,
                self._cells,
                self._cell,
                self._dt,
                self._hidden,
                self._total,
                course.states[k:],
                course.variances[k:],
                sizes,
                shares,
                course.still[k:],
                course.resting[k:],
            )
        except np.linalg.LinAlgError:
            return 0
        if not count:
            return 0
        listed = shares[:count].tolist()
        self._judge.note_all(listed)
        self._last = readings[count - 1]
        self.loss.find()
        misfit, strain = self.misfit, self._strain
        for size, share in zip(sizes[:count].tolist(), listed, strict=True):  # in turn, however readings come
            misfit += size
            strain += share
        self.misfit, self._strain = misfit, strain
        self._strained += count
        return count
