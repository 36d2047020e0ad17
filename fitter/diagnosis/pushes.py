"""Pushes: when there were any is part of the finding, as it is of loads (`loads`).

They are sought over the whole run, learning and evaluating trials alike, for a trial that was not affected says
nothing of them, and one that was cannot be predicted from others.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.unknown_torque import intervals
from fitter.diagnosis.view import View
from fitter.side_by_side import side_by_side

#: Pushes are sought in steps of this length, and up to so many of them [s].
_TILE_S, _LONGEST = 0.1, 20
#: No more pushes than this are sought at a joint, and none that explains less than this share of the first.
_MOST_PUSHES, _LEAST_SHARE = 6, 0.05
#: While a joint is stuck nobody can tell a push: of runs that explain this share of the most, the shortest.
_NEARLY = 0.99
#: … and it is moved and stretched only where that explains so many times what it did.
_CLEARLY = 1.002
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


def with_free_times(model: Model) -> Model:
    """Return a model whose pushes may be moved and stretched."""
    free = Model()
    for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
        if isinstance(hypothesis, Pushes):
            one = Pushes(hypothesis.kind, hypothesis.joints[0], hypothesis.found, free=True)
            free = free.plus(one, one.starts([])[0])
        else:
            free = free.plus(hypothesis, psi)
    return free


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


def find_pushes(kind: EffectKind, regression: Regression, model: Model, x: Floats) -> list[Hypothesis]:
    """Return the pushes that explain most of what a model leaves, one hypothesis a joint.

    Torque is made of tiles; the gain of any run of tiles with one height is ``(sum of s)^2 / (sum of G)``, s and G
    being the tiles' products with the residual and with each other.
    """
    left = [regression.residual(model, x, motion).ravel() for motion in regression.motions]
    joints = range(regression.arm.n_joint)
    # Here, not in other processes: what is made once is used in every search.
    boxes = [[regression.weighting.boxes(motion, j, _TILE_S) for motion in regression.motions] for j in joints]
    found = side_by_side(lambda j: _pushes_at(regression, j, boxes[j], list(left)), joints)
    return [Pushes(kind, j, times) for j, times in enumerate(found)]


def _pushes_at(
    regression: Regression, joint: int, boxes: list[tuple[Floats, Floats]], left: list[Floats]
) -> Floats:
    """Return starts and durations of the pushes at one joint, (n_push, 2); what is left is used up."""
    motions = regression.motions
    runs = [_best_run(G, T.T @ r) for (T, G), r in zip(boxes, left, strict=True)]
    found: list[tuple[float, float]] = []
    most = 0.0
    while len(found) < _MOST_PUSHES:
        k = max(range(len(runs)), key=lambda k: runs[k][0])
        gain, first, last = runs[k]
        if found and gain < _LEAST_SHARE * most:
            break
        start, duration = float(motions[k].t[0]) + _TILE_S * first, _TILE_S * (last - first + 1)
        push = _placed(regression, motions[k], joint, left[k], start, duration)
        most = max(most, push.gain)
        found.append((push.start, push.duration))
        column = push.column
        left[k] = left[k] - column * (column @ left[k]) / max(float(column @ column), 1e-300)
        T, G = boxes[k]
        runs[k] = _best_run(G, T.T @ left[k])
    return np.array(sorted(found))


@dataclass(frozen=True)
class _Placed:
    """A push and what it explains: (n_row,) is its filtered column."""

    gain: float
    start: float
    duration: float
    column: Floats


def _placed(
    regression: Regression, motion: Motion, joint: int, left: Floats, start: float, duration: float
) -> _Placed:
    """Return a push, moved and stretched until it explains most; of two that do as well, the one less at rest."""

    def tried(at: float, lasting: float) -> _Placed:
        column = regression.weighting.filtered_at(motion, joint, _box(motion, at, lasting)[:, None]).ravel()
        gain = float(column @ left) ** 2 / max(float(column @ column), 1e-300)
        return _Placed(gain, at, lasting, column)

    def moved(best: _Placed) -> _Placed:
        step = _TILE_S / 2.0
        while step > motion.dt_s / 2.0:
            for begin, end in ((-step, 0.0), (step, 0.0), (0.0, -step), (0.0, step)):
                at, lasting = best.start + begin, best.duration - begin + end
                if lasting >= 2.0 * motion.dt_s:
                    other = tried(at, lasting)
                    best = other if other.gain > _CLEARLY * best.gain else best
            step /= 2.0
        return best

    best = moved(tried(start, duration))
    for at, lasting in _beside_rests(motion, joint, best.start, best.duration):
        other = moved(tried(at, lasting))
        best = other if _CLEARLY * other.gain > best.gain else best
    return best


def _beside_rests(motion: Motion, joint: int, start: float, duration: float) -> list[tuple[float, float]]:
    """Return the push without the rest that it begins in, and without the one that it ends in.

    No small step leads across a rest, in which nobody feels it.
    """
    end, near, shorter = start + duration, _NEAR * motion.dt_s, []
    for first, last in intervals(motion.stuck[:, joint]):
        begun, over = float(motion.t[first]), float(motion.t[last - 1])
        if begun - near <= start < over < end:
            shorter.append((over, end - over))
        if start < begun < end <= over + near:
            shorter.append((start, begun - start))
    return shorter


def _box(motion: Motion, start: float, duration: float) -> Floats:
    """Return 1 during a push and 0 before and after; the first and last sample count by their part."""
    t, dt_s = motion.t, motion.dt_s
    begun = np.clip((t - start) / dt_s + 0.5, 0.0, 1.0)
    return np.asarray(begun * np.clip((start + duration - t) / dt_s + 0.5, 0.0, 1.0), dtype=np.float64)


def _best_run(G: Floats, s: Floats) -> tuple[float, int, int]:
    """Return gain, first and last tile of the shortest run of tiles that explains all but a little of the most."""
    area = np.zeros((len(s) + 1, len(s) + 1))
    area[1:, 1:] = np.cumsum(np.cumsum(G, axis=0), axis=1)
    reach = np.concatenate([[0.0], np.cumsum(s)])
    runs = []
    floor = 1e-6 * float(np.max(np.diag(G)))
    for length in range(1, min(_LONGEST, len(s)) + 1):
        first = np.arange(len(s) - length + 1)
        last = first + length
        size = area[last, last] - area[first, last] - area[last, first] + area[first, first]
        gain = (reach[last] - reach[first]) ** 2 / np.maximum(size, floor)
        k = int(np.argmax(gain))
        runs.append((float(gain[k]), int(first[k]), int(last[k] - 1)))
    most = max(gain for gain, _, _ in runs)
    return next(run for run in runs if run[0] >= _NEARLY * most)
