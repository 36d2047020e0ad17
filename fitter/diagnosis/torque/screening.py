"""What each hypothesis would gain in an accepted model, its weights as they are: where a fit begins."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.torque.likelihood import Fit, TorqueLikelihood
from fitter.side_by_side import side_by_side

#: A column of which others leave less than this share of its length is made by them.
_FRESH = 1e-4
#: Steps from a start near nothing, where what a hypothesis can gain does not show yet.
_STEPS = 4


@dataclass(frozen=True)
class Screened:
    """The best start of a hypothesis: its psi, the gain there [nats], and how many starts were tried."""

    hypothesis: Hypothesis
    psi: Floats
    gain: float
    n_start: int


class Screening:
    """What hypotheses would gain beside a fit.

    Parameters
    ----------
    likelihood : TorqueLikelihood
    fit : Fit
    """

    def __init__(self, likelihood: TorqueLikelihood, fit: Fit) -> None:
        self._likelihood, self._fit = likelihood, fit
        self._weights = likelihood.weights_of(fit)
        self._trials = likelihood.trials_of(fit.model)
        self._views = {motion.number: likelihood.view(fit.model, motion) for motion in self._trials}
        rows = self._rows(fit.model)
        A = np.vstack([one[:, :-1] for one in rows])
        y = np.concatenate([one[:, -1] for one in rows])
        A = np.hstack([A, self._slopes(fit)])
        size = np.linalg.norm(A, axis=0)
        Q, R, _ = scipy.linalg.qr(A / np.where(size > 0.0, size, 1.0), mode="economic", pivoting=True)
        kept = np.abs(np.diag(R)) > 1e-9 * abs(R[0, 0])
        self._Q = np.asarray(Q[:, kept])
        self.residual = y - self._Q @ (self._Q.T @ y)
        self._ends = np.cumsum([len(one) for one in rows])[:-1]

    def _rows(self, model: Model) -> list[Floats]:
        return [
            self._weights[motion.number].rows(self._likelihood.system(model, motion, noisy=False).Z)
            for motion in self._trials
        ]

    def _slopes(self, fit: Fit) -> Floats:
        """Return by how much the residual moves with each accepted psi, (n_row, n_psi)."""
        solution, joints = np.append(fit.x, -1.0), self._likelihood.arm.n_joint
        n_row = sum(2 * len(self._likelihood.spectra[motion.number].f) * joints for motion in self._trials)
        columns = [np.zeros((n_row, 0))]
        for more, less, apart in fit.model.beside():
            both = zip(self._rows(more), self._rows(less), strict=True)
            columns.append(np.concatenate([(a - b) @ solution for a, b in both])[:, None] / apart)
        return np.hstack(columns)

    def all(self, tried: Sequence[Hypothesis]) -> list[Screened]:
        """Return every hypothesis at its best start, the one that gains most first."""
        linear = [one for one in tried if one.n_column and not one.is_event]
        others = [one for one in tried if not (one.n_column and not one.is_event)]
        found = [self._linear(one) for one in linear]
        numbers = side_by_side(self._other, others)
        found += [Screened(one, *three) for one, three in zip(others, numbers, strict=True)]
        return sorted(found, key=lambda one: -one.gain)

    def _linear(self, hypothesis: Hypothesis) -> Screened:
        """Return the best start of a hypothesis whose columns stand beside the base's."""
        starts, width = hypothesis.starts(self._trials), hypothesis.n_column
        gram = np.zeros((len(starts), width, width))
        pull = np.zeros((len(starts), width))
        shared = np.zeros((self._Q.shape[1], len(starts) * width))
        residual = np.split(self.residual, self._ends)
        Q = np.split(self._Q, self._ends)
        for motion, r, q in zip(self._trials, residual, Q, strict=True):
            view = self._views[motion.number]
            first = len(view.columns)
            added = [one for psi in starts for one in hypothesis.act(view, psi).columns[first:]]
            columns = np.concatenate(added, axis=2) * view.factor[:, None]
            rows = self._weights[motion.number].rows(self._likelihood.spectra[motion.number].of(columns))
            by_start = rows.reshape(len(rows), len(starts), width)
            gram += np.einsum("nsi,nsj->sij", by_start, by_start)
            pull += (rows.T @ r).reshape(len(starts), width)
            shared += q.T @ rows
        across = shared.reshape(self._Q.shape[1], len(starts), width)
        gains = [_gain(gram[k], gram[k] - across[:, k].T @ across[:, k], pull[k]) for k in range(len(starts))]
        best = int(np.argmax(gains))
        return Screened(hypothesis, starts[best], gains[best], len(starts))

    def _other(self, hypothesis: Hypothesis) -> tuple[Floats, float, int]:
        """Return the best start of a hypothesis that changes angles, torque or the arm."""
        starts = hypothesis.starts(self._trials)
        left = 0.5 * float(self.residual @ self.residual)
        gains = []
        for psi in starts:
            rows = np.vstack(self._rows(self._fit.model.plus(hypothesis, psi)))
            gains.append(left - 0.5 * _left(rows))
        best = int(np.argmax(gains))
        if hypothesis.is_gradual:
            model, held = self._fit.model.plus(hypothesis, starts[best]), len(self._fit.model.hypotheses)
            x = self._likelihood.begun(self._fit, model)
            own, floors = self._fit.own, self._fit.floors
            model = self._likelihood.refined(model, self._trials, self._weights, own, floors, x, held, _STEPS)
            return model.psi[-1], left - 0.5 * _left(np.vstack(self._rows(model))), len(starts)
        return starts[best], gains[best], len(starts)


def _left(rows: Floats) -> float:
    """Return the sum of squares that columns leave of the last one."""
    gram = rows.T @ rows
    size = np.sqrt(np.diag(gram)[:-1])
    size[size == 0.0] = 1.0
    values, axes = np.linalg.eigh(gram[:-1, :-1] / np.outer(size, size))
    kept = values > 1e-12 * values.max(initial=0.0)
    along = axes[:, kept].T @ (gram[:-1, -1] / size)
    return float(gram[-1, -1] - np.sum(along**2 / values[kept]))


def _gain(own: Floats, alone: Floats, pull: Floats) -> float:
    """Return by how much columns raise the log-likelihood, by their products with each other and the residual."""
    fresh = np.diag(alone) > _FRESH**2 * np.diag(own)
    if not np.any(fresh):
        return 0.0
    part, wanted = alone[np.ix_(fresh, fresh)], pull[fresh]
    return 0.5 * float(wanted @ np.linalg.lstsq(part, wanted, rcond=1e-10)[0])
