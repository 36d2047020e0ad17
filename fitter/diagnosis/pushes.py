"""Pushes: when there were any is part of the finding, as it is of loads (`payload`).

They are sought over the whole run, learning and evaluating trials alike, for a trial that was not affected says
nothing of them, and one that was cannot be predicted from others.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View

#: A start may move by two of these when it is refined, a duration by four [s].
_TILE_S = 0.1
#: A push begins in a rest if the joint is stuck within so many samples before it.
_NEAR = 4


class Pushes(Hypothesis):
    """Some pushes at one joint.

    Parameters
    ----------
    kind : EffectKind
    joint : int
    found : (n_push, 2)
        Starts and durations [s].
    free : bool
        Whether psi holds starts and durations, to be refined; otherwise there is none.
    """

    is_event = True
    is_inertial = False
    comes_and_goes = True
    is_noisy = False

    def __init__(self, kind: EffectKind, joint: int, found: Floats, free: bool = False) -> None:
        super().__init__(kind, (joint,))
        self.found = np.asarray(found, dtype=np.float64)
        self.free = free
        self.n_column = len(found)

    @property
    def n_number(self) -> int:
        """Start, duration and torque of each."""
        return 3 * self.n_column

    @property
    def low(self) -> Floats:
        """Least values of psi: no push moves by more than two tiles."""
        if not self.free:
            return np.zeros(0)
        return np.ravel(np.stack([self.found[:, 0] - 2 * _TILE_S, np.full(len(self.found), 0.01)], axis=1))

    @property
    def high(self) -> Floats:
        """Greatest values of psi."""
        if not self.free:
            return np.zeros(0)
        return np.ravel(np.stack([self.found[:, 0] + 2 * _TILE_S, self.found[:, 1] + 4 * _TILE_S], axis=1))

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return what was found."""
        return self.found.reshape(1, -1) if self.free else np.zeros((1, 0))

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion with a column a push."""
        columns = np.zeros((*view.q.shape, self.n_column))
        for k, (start, duration) in enumerate(self._times(psi)):
            columns[:, self.joints[0], k] = -_box(view.motion, start, duration)
        return replace(view, columns=(*view.columns, columns))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return start, duration and torque of each push."""
        return np.column_stack([self._times(psi), factors]).ravel()

    def hidden(self, motions: Sequence[Motion], values: Floats) -> Floats:
        """Return the error of starts and durations for a push that a stuck joint does not feel."""
        errors = np.zeros((len(values) // 3, 3))
        for k, (start, duration, _) in enumerate(np.reshape(values, (-1, 3))):
            before = _unfelt(motions, self.joints[0], start, -1)
            after = _unfelt(motions, self.joints[0], start + duration, 1)
            errors[k, :2] = before / np.sqrt(12.0), np.hypot(before, after) / np.sqrt(12.0)
        return errors.ravel()

    def _times(self, psi: Floats) -> Floats:
        return np.reshape(psi, (-1, 2)) if self.free else self.found

    @property
    def names(self) -> tuple[str, ...]:
        """Numbered where there are several pushes."""
        names = [parameter.name for parameter in self.kind.parameters]
        if self.n_column == 1:
            return tuple(names)
        return tuple(f"{name}_{k + 1}" for k in range(self.n_column) for name in names)

    @property
    def units(self) -> tuple[str, ...]:
        """Of each."""
        return tuple(parameter.unit for parameter in self.kind.parameters) * self.n_column


def _unfelt(motions: Sequence[Motion], joint: int, at: float, way: int) -> float:
    """Return for how long before (-1) or after (1) an instant a joint stands still, 0 if it moves then [s]."""
    for motion in motions:
        if motion.t[0] <= at <= motion.t[-1]:
            k = round((at - motion.t[0]) / motion.dt_s)
            stuck = motion.stuck[: k + 1, joint][::-1] if way < 0 else motion.stuck[k:, joint]
            if not np.any(stuck[:_NEAR]):
                return 0.0
            return float(np.argmin([*stuck[int(np.argmax(stuck)) :], False])) * motion.dt_s
    return 0.0


def _box(motion: Motion, start: float, duration: float) -> Floats:
    """Return 1 during a push and 0 before and after; the first and last sample count by their part."""
    t, dt_s = motion.t, motion.dt_s
    begun = np.clip((t - start) / dt_s + 0.5, 0.0, 1.0)
    return np.asarray(begun * np.clip((start + duration - t) / dt_s + 0.5, 0.0, 1.0), dtype=np.float64)
