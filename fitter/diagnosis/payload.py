"""Loads at the tip: in which trials, or from when on, one was carried.

As pushes are, they are sought over the whole run, learning and evaluating trials alike.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind
from arm.model import Floats, JointType
from arm.regressor import regressor
from fitter.diagnosis.least_squares import BLOCK_S, ROUNDED, scaled_lstsq
from fitter.diagnosis.model import Hypothesis, Model
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.sharp_columns import behind_filter

#: Products of a column with the residual, with itself, and with the design.
_Parts = tuple[float, float, Floats]


class Payload(Hypothesis):
    """A point mass at the tip, in some trials or from some time on.

    Parameters
    ----------
    kind : EffectKind
    trials : frozenset of int
        The trials in which it is there, from 1 over the run; or
    since_s : float, optional
        from when on, about: its psi is how much later, in blocks of a second, from 1.
    """

    n_column = 1
    is_event = True
    is_intermittent = True

    def __init__(
        self, kind: EffectKind, trials: frozenset[int] = frozenset(), since_s: float | None = None
    ) -> None:
        super().__init__(kind, ())
        self.trials = trials
        self.since_s = since_s

    @property
    def low(self) -> Floats:
        """How much earlier it may have come, (n_psi,)."""
        return np.zeros(0) if self.since_s is None else np.zeros(1)

    @property
    def high(self) -> Floats:
        """How much later, (n_psi,)."""
        return 2.0 + self.low

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return the moment at which it was found, (1, n_psi)."""
        return np.ones((1, len(self.low)))

    def _since(self, psi: Floats) -> Floats:
        """Return from when on it is there, (n_psi,) [s]."""
        return np.zeros(0) if self.since_s is None else np.asarray(self.since_s + BLOCK_S * (psi - 1.0))

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with what a kilogram at the tip would ask of the joints while it is there."""
        column, motion = tip_mass_column(hypothetical), hypothetical.motion
        guessed = hypothetical.guessed
        for since_s in self._since(psi):
            there = behind_filter(motion, partial(_lasted, since_s=since_s), (since_s, since_s))
            column = column * there[:, None, None]
            guessed = guessed | (np.abs(motion.t - since_s) < _smeared_s([motion]))
        if self.since_s is None and motion.number not in self.trials:
            column = np.zeros_like(column)
        return replace(hypothetical, columns=(*hypothetical.columns, column), guessed=guessed)

    def log_places(self, motions: Sequence[Motion]) -> float:
        """Return the logarithm of the number of sets of trials, or of moments."""
        if self.since_s is None:
            return float(len(motions) * np.log(2.0))
        return float(np.log(sum(len(motion.t) for motion in motions)))

    def acts_in(self, motion: Motion) -> bool:
        """Say whether it is carried there, for a part of it at least."""
        return bool(self.part_of(motion))

    def part_of(self, motion: Motion) -> object:
        """Return whether it is there, or from when on."""
        if self.since_s is None:
            return motion.number in self.trials
        begun = motion.t[[0, -1]] >= self.since_s
        return bool(begun[0]) if begun[0] == begun[1] else self.since_s

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the mass, and from when on it is there."""
        return np.concatenate([factors, self._since(psi)])

    def standard_errors(self, of_fit: Floats, motions: Sequence[Motion]) -> Floats:
        """Return them with what no fit shows of the moment: the filter smears a jump of the acceleration."""
        hidden = np.zeros(len(of_fit))
        hidden[1:] = _smeared_s(motions) / np.sqrt(12.0)  # uniform
        return np.asarray(np.hypot(of_fit, hidden))

    @property
    def names(self) -> tuple[str, ...]:
        """Trials are no number with an error."""
        return ("mass_kg",) if self.since_s is None else ("mass_kg", "since_s")

    def units_at(self, joint: JointType) -> tuple[str, ...]:
        """Return those of the mass and of the time since which it is there."""
        return ("kg",) if self.since_s is None else ("kg", "s")


def _smeared_s(motions: Sequence[Motion]) -> float:
    """Return over which time columns smear what is sharp: half a period of their corner, or a step [s]."""
    return max(max(motion.dt_s, 0.5 / motion.trial.cutoff_hz) for motion in motions)


def _lasted(until: Floats, since_s: float) -> Floats:
    """Return for how long a load that came at some time has been there, (n,) [s]."""
    return np.maximum(until - since_s, 0.0)


def tip_mass_column(hypothetical: HypotheticalMotion) -> Floats:
    """Return the torque of one kilogram at the tip, (n_sample, n_joint, 1)."""
    n = hypothetical.arm.n_joint
    a = hypothetical.arm.joints[-1].a_m
    mass = np.zeros(12 * n)
    mass[10 * (n - 1) : 10 * n] = [0.0, a * a, a * a, 0.0, 0.0, 0.0, a, 0.0, 0.0, 1.0]
    torque = regressor(hypothetical.arm, hypothetical.q, hypothetical.dq, hypothetical.ddq) @ mass
    return np.asarray(torque[..., None], dtype=np.float64)


class _Sums:
    """What a kilogram at the tip would explain, by sums over trials: any set of them, and from any moment on."""

    def __init__(self, regression: Regression, model: Model) -> None:
        self._regression, self._model = regression, model
        self.motions = regression.motions
        rows = [regression.rows(model, motion) for motion in self.motions]
        A, y = np.vstack([one.design for one in rows]), np.concatenate([one.target.ravel() for one in rows])
        size = np.linalg.norm(A, axis=0)
        self._size = np.where(size > 0.0, size, 1.0)
        x = scaled_lstsq(A, y)
        self._designs = [one.design / self._size for one in rows]
        self._left = [one.target.ravel() - one.design @ x for one in rows]
        A = A / self._size
        self._inverse = np.linalg.pinv(A.T @ A, rcond=ROUNDED, hermitian=True)
        hypotheticals = [regression.hypothetical(model, motion) for motion in self.motions]
        self._columns = [
            tip_mass_column(hypothetical) * hypothetical.factor[:, None] for hypothetical in hypotheticals
        ]
        self.whole = [self.of(k, [-np.inf])[0] for k in range(len(self.motions))]

    def of(self, k: int, since_s: Sequence[float] | Floats) -> list[_Parts]:
        """Return a trial's products of its column with the residual, itself and the design, from moments on."""
        motion = self.motions[k]
        columns = self._columns[k] * (motion.t[:, None] >= np.asarray(since_s))[:, None, :]
        C = self._regression.weighting.filtered(motion, columns).reshape(-1, len(since_s))
        across = self._designs[k].T @ C
        return list(zip(self._left[k] @ C, np.sum(C**2, axis=0), across.T, strict=True))

    def gain(self, parts: Sequence[_Parts]) -> float:
        """Return by how much the column made of some parts lowers the sum of squares, the base fitted anew."""
        if not parts:
            return 0.0
        s, q, B = (sum(column) for column in zip(*parts, strict=True))
        alone = float(q - B @ self._inverse @ B)
        return float(s**2 / alone) if alone > np.sqrt(ROUNDED) * q else 0.0

    def masses(self) -> Floats:
        """Return each trial's load when every trial may have one of its own; a common part is the arm's."""
        s, q, B = (np.array(column) for column in zip(*self.whole, strict=True))
        normal = np.diag(q) - B @ self._inverse @ B.T
        return np.asarray(np.linalg.lstsq(normal, s, rcond=np.sqrt(ROUNDED))[0], dtype=np.float64)


def find_payloads(regression: Regression, model: Model) -> list[Hypothesis]:
    """Return the trials, and the moment, whose load at the tip would explain most of a model's residual.

    None where it has a load already.
    """
    if any(isinstance(hypothesis, Payload) for hypothesis in model.hypotheses):
        return []
    kind, sums = catalogue()["payload"], _Sums(regression, model)
    order = np.argsort(sums.masses())[::-1]
    gains = [sums.gain([sums.whole[k] for k in order[: count + 1]]) for count in range(len(order) - 1)]
    heaviest = order[: int(np.argmax(gains)) + 1] if gains else order[:0]
    trials = frozenset(sums.motions[k].number for k in heaviest)
    found: list[Hypothesis] = [Payload(kind, trials)] if trials else []
    return [*found, Payload(kind, since_s=_moment(sums))]


def _moment(sums: _Sums) -> float:
    """Return the moment from which a load explains most [s]: in the trial by which it has begun, or before it."""
    last = max(range(len(sums.motions)), key=lambda k: sums.gain(sums.whole[k:]))
    near = [k for k in (last - 1, last) if k >= 0]
    tried = [(k, _moments(sums.motions[k])) for k in near]
    _, k, at = max(_gained(sums, k, moments) for k, moments in tried)
    near_s = np.ptp(_moments(sums.motions[k])[:2])
    return _gained(sums, k, np.arange(at - near_s, at + near_s, sums.motions[k].dt_s))[2]


def _gained(sums: _Sums, k: int, moments: Floats) -> tuple[float, int, float]:
    """Return the most that a load explains from one of some moments of a trial on, the trial, and the moment."""
    after = sums.whole[k + 1 :]
    gains = [sums.gain([part, *after]) for part in sums.of(k, moments)]
    best = int(np.argmax(gains))
    return gains[best], k, float(moments[best])


def _moments(motion: Motion) -> Floats:
    """Return moments of a trial, as far apart as there are of its samples between two of them."""
    return np.linspace(motion.t[0], motion.t[-1], math.isqrt(len(motion.t)), endpoint=False)
