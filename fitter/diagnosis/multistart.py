"""Multistart: what each start of a hypothesis would explain on some trials, added to what is accepted.

The psi of what is accepted are where they do best alone, which may be far from where they do beside another. So
they are free as far as a straight line goes: what they could explain, by their slopes, is taken from both sides.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import N_REFINED, NEGLIGIBLE, ROUNDED, solved
from fitter.diagnosis.model import Hypothesis, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.refinement import Misfit, Starts, peaks, refined
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.weighting import Columns


@dataclass(frozen=True)
class Best:
    """The best start of a hypothesis.

    Attributes
    ----------
    gain : float
        By how much it lowers the sum of squares.
    psi : (n_psi,)
    best : (n, n_psi)
        The best few, from which it may be found again.
    """

    gain: float
    psi: Floats
    best: Floats


class Multistart:
    """What each start of a hypothesis would explain on some trials."""

    def __init__(
        self,
        regression: Regression,
        model: Model,
        starts: Starts,
        motions: Sequence[Motion] | None = None,
        run: Sequence[Motion] | None = None,
    ) -> None:
        self._regression, self._model, self._starts = regression, model, starts
        self._motions = list(motions or regression.motions_of(model))
        self._run = list(run or regression.motions)
        rows = [regression.rows(model, motion) for motion in self._motions]
        self._views = [regression.hypothetical(model, motion) for motion in self._motions]
        A = np.vstack([one.design for one in rows])
        self._target = np.concatenate([one.target.ravel() for one in rows])
        size = np.linalg.norm(A, axis=0)
        Q, R, _ = scipy.linalg.qr(A / np.where(size > 0.0, size, 1.0), mode="economic", pivoting=True)
        is_determined = np.abs(np.diag(R)) > np.sqrt(ROUNDED) * abs(R[0, 0])
        self._tangent = _complement_basis(np.asarray(Q[:, is_determined]), self._slopes())
        self._Q = np.hstack([Q[:, is_determined], self._tangent])
        self._residual = self._target - self._Q @ (self._Q.T @ self._target)
        self.chi2 = float(self._residual @ self._residual)
        self._ends = np.cumsum([len(one.columns.white) for one in rows])[:-1]
        both = np.split(np.column_stack([self._Q, self._residual]), self._ends)
        freed = regression.weighting.freed
        self._again = [freed(motion, one) for motion, one in zip(self._motions, both, strict=True)]

    def _slopes(self) -> Floats:
        """Return what a change of each accepted psi makes, (n_row, n_psi)."""
        regression, model, motions = self._regression, self._model, self._motions
        if not len(model.flat):
            return np.zeros((len(self._target), 0))
        x = regression.solve(model, motions)
        columns = [
            [(regression.residual(less, x, one) - regression.residual(more, x, one)).ravel() for one in motions]
            for more, less, _ in model.central_differences()
        ]
        return np.stack([np.concatenate(one) for one in columns], axis=1)

    def best(self, hypothesis: Hypothesis, rounds: int = 4) -> Best:
        """Return the start of a hypothesis that lowers the sum of squares most.

        Gradual ones take some rounds, and those that replace what the arm has: from its numbers on. A round goes
        twice as far as the one before at the most, so a straight step from nothing is a start as well.
        """
        expected, straight = self._straight(hypothesis) if hypothesis.nothing else (0.0, None)
        if straight is not None and max(expected, straight.gain) < NEGLIGIBLE * self.chi2:
            return straight
        starts = self._foremost(hypothesis, self._starts_of(hypothesis))
        if straight is not None:
            starts = np.vstack([starts, straight.psi])
        gains = self._gains_of(hypothesis, starts)
        order = np.argsort(-np.array(gains), kind="stable")
        psi, gain, best = starts[order[0]], gains[order[0]], starts[order[:N_REFINED]]
        if hypothesis.is_gradual or self._replaced(hypothesis):
            model = self._model.plus(hypothesis, psi)
            psi = refined(self._regression, model, self._motions, len(self._model.hypotheses), rounds).psi[-1]
            gain = self._gain(hypothesis, psi)
        return Best(gain, psi, best)

    def _straight(self, hypothesis: Hypothesis) -> tuple[float, Best | None]:
        """Return by how much a straight step from nothing should lower the sum of squares, and where it leads.

        Where the least of a hypothesis makes parameters be felt that were not, no slope leads from nothing.
        """
        nothing = np.array(hypothesis.nothing)
        model, held = self._model.plus(hypothesis, nothing), len(self._model.hypotheses)
        somewhat = self._model.plus(hypothesis, hypothesis.starts(self._motions)[0])
        without, felt = (self._regression.hypothetical(one, self._motions[0]).arm for one in (model, somewhat))
        sought = self._regression.equations.independent
        if not np.array_equal(sought(without), sought(felt)):
            return 0.0, None
        misfit = Misfit(self._regression, model, self._motions, held)
        both = np.column_stack([misfit.slopes(nothing), misfit.residual(nothing)])[: len(self._target)]
        both -= self._tangent @ (self._tangent.T @ both)
        slopes, residual = both[:, :-1], both[:, -1]
        step = solved(slopes.T @ slopes, -slopes.T @ residual)
        there = hypothesis.inside(np.clip(nothing + step, misfit.low, misfit.high))
        expected = -float(residual @ (slopes @ step))
        return expected, Best(self._gain(hypothesis, there), there, there[None])

    def gain(self, hypothesis: Hypothesis, psi: Floats) -> float:
        """Return by how much a hypothesis with some psi lowers the sum of squares."""
        return self._gains_of(hypothesis, psi[None])[0]

    def _gains_of(self, hypothesis: Hypothesis, starts: Floats) -> list[float]:
        if hypothesis.is_event:
            return self._gains_in_run(hypothesis, starts)
        if hypothesis.n_column:
            return self._gains(hypothesis, starts)
        return [self._gain(hypothesis, psi) for psi in starts]

    def _foremost(self, hypothesis: Hypothesis, starts: Floats) -> Floats:
        """Return the starts to try on all trials: of many that cost a fit each those that do best on the worst."""
        if len(starts) <= N_REFINED or (hypothesis.n_column and not hypothesis.is_event):
            return starts
        gains = np.array(self._worst._gains_of(hypothesis, starts))  # noqa: SLF001 - of its own class
        most = N_REFINED if hypothesis.is_gradual or gains.max() > NEGLIGIBLE * self._worst.chi2 else 1
        return np.asarray(starts[np.argsort(-gains, kind="stable")[:most]], dtype=np.float64)

    @cached_property
    def _worst(self) -> "Multistart":
        """The same on the trials with the largest residuals."""
        parts = np.split(self._residual, self._ends)
        motions = self._largest_residuals(self._motions, np.array([one @ one for one in parts]))
        run = self._largest_residuals(self._run, self._run_chi2)
        return Multistart(self._regression, self._model, self._starts, motions, run)

    def _largest_residuals(self, motions: Sequence[Motion], chi2: Floats) -> list[Motion]:
        ratio = chi2 / [self._regression.weighting.n_effective(motion) for motion in motions]
        kept = np.argsort(-ratio)[:N_REFINED]
        return [motions[k] for k in sorted(kept)]

    def _starts_of(self, hypothesis: Hypothesis) -> Floats:
        known = self._starts.of(self._model, hypothesis)
        if known is not None:
            return known
        if isinstance(hypothesis, JointHypothesis) and "frequency_hz" in hypothesis.psi_names:
            residual = self._residual.reshape(-1, self._regression.arm.n_joint)[:, hypothesis.joints[0]]
            return peaks(residual, self._motions, self._regression.weighting)
        starts = hypothesis.starts(self._run if hypothesis.is_event else self._motions)
        return np.vstack([*self._replaced(hypothesis), starts])

    def _replaced(self, hypothesis: Hypothesis) -> list[Floats]:
        """Return the psi of those that the arm has and that a hypothesis replaces."""
        given = self._regression.equations.given
        return [psi for one, psi in zip(given.hypotheses, given.psi, strict=True) if hypothesis.replaces(one)]

    def _gains_in_run(self, hypothesis: Hypothesis, starts: Floats) -> list[float]:
        """Return the gains of what need not show in the learning trials, by all trials."""
        was = float(self._run_chi2.sum())
        return [was - float(self._in_run(self._model.plus(hypothesis, psi)).sum()) for psi in starts]

    @cached_property
    def _run_chi2(self) -> Floats:
        return self._in_run(self._model)

    def _in_run(self, model: Model) -> Floats:
        """Return what a model that is fitted to all trials leaves in each."""
        x = self._regression.solve(model, self._run)
        return self._regression.squares(model, x, self._run)

    def _gain(self, hypothesis: Hypothesis, psi: Floats) -> float:
        return self._accepted_chi2 - self._chi2_of(self._model.plus(hypothesis, psi))

    @cached_property
    def _accepted_chi2(self) -> float:
        """What the accepted model leaves as models are fitted: friction that brakes, masses by their density."""
        return self._chi2_of(self._model)

    def _chi2_of(self, model: Model) -> float:
        r = self._regression.residuals(model, self._regression.solve(model, self._motions), self._motions)
        straight = self._tangent.T @ r
        return float(r @ r) - float(straight @ straight)

    def _gains(self, hypothesis: Hypothesis, starts: Floats) -> list[float]:
        """Return the gains of columns added to all others, those of all starts filtered together.

        No more than their products with each other, with all others and with the residual is needed.
        """
        first, width, weighting = len(self._views[0].columns), hypothesis.n_column, self._regression.weighting
        grams, rhs_parts = [], []
        for hypothetical, again in zip(self._views, self._again, strict=True):
            added = [one for psi in starts for one in hypothesis.act(hypothetical, psi).columns[first:]]
            rows = weighting.whitened(
                hypothetical.motion, np.concatenate(added, axis=2) * hypothetical.factor[:, None]
            )
            C = Columns(weighting, hypothetical.motion, rows.reshape(-1, rows.shape[2]))
            grams.append([C.gram[k : k + width, k : k + width] for k in range(0, len(C.gram), width)])
            rhs_parts.append(again.T @ C.white)
        both = np.sum(rhs_parts, axis=0)
        shared, rhs = both[:-1], both[-1]
        found = []
        for k, own in enumerate(np.sum(grams, axis=0)):
            its = slice(k * width, (k + 1) * width)
            others = shared[:, its]
            alone = own - others.T @ others
            fresh = np.diag(alone) > np.sqrt(ROUNDED) * np.diag(own)
            found.append(_gain_of(alone[np.ix_(fresh, fresh)], rhs[its][fresh]))
        return found


def _complement_basis(Q: Floats, columns: Floats) -> Floats:
    """Return an orthonormal basis of columns' complement to the span of another basis."""
    size = np.linalg.norm(columns, axis=0)
    columns = (columns - Q @ (Q.T @ columns)) / np.where(size > 0.0, size, 1.0)
    U, length, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(U[:, length > np.sqrt(ROUNDED)], dtype=np.float64)


def _gain_of(gram: Floats, rhs: Floats) -> float:
    """Return by how much columns lower a sum of squares, by their products with each other and the residual."""
    return float(rhs @ solved(gram, rhs)) if len(rhs) else 0.0
