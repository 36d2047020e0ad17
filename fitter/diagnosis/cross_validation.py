"""What the residual torque depends on: functions of variables, by cross-validation over trials.

Whether it depends on a variable at all, whatever the shape, says Chatterjee's rank correlation (2021). Sorted by
the variable, neighbouring residuals resemble each other if one is a function of the other:
``xi = 1 - 3 sum |r_(i+1) - r_i| / (n^2 - 1)`` with r the residual's ranks. What chance gives is found by shifting
the residual along the run, which keeps its own memory and the variable's.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.diagnosis.basis_functions import BasisFunctions, Dependence, spellings, symbolic_terms
from fitter.diagnosis.least_squares import NEGLIGIBLE, ROUNDED, TINY, UNEXPLAINED, scaled_lstsq
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.weighting import Columns


def residual_torque(regression: Regression, model: Model, x: Floats, motion: Motion) -> Floats:
    """Return the torque that a model leaves, smoothed, NaN where stuck, (n_sample, n_joint) [N m or N]."""
    residual = regression.equations.residual_torque(model, x, motion)
    residual = lowpass(residual, motion.dt_s, regression.weighting.seen_hz)
    return np.where(motion.stuck, np.nan, residual)


def dependences(
    regression: Regression, final: Candidate, n_shifted: int = 99, n_instant: int = 1500
) -> list[Dependence]:
    """Return the dependence of every joint's remaining torque on every variable.

    Parameters
    ----------
    regression : Regression
    final : Candidate
    n_shifted : int
        Shifts in time that say what chance gives: the least p is a hundredth (Davison and Hinkley 1997).
    n_instant : int
        Instants at which it is looked at.
    """
    n_joint, rng = regression.arm.n_joint, np.random.default_rng(0)
    motions = regression.motions
    residual = np.concatenate([residual_torque(regression, final.model, final.x, motion) for motion in motions])
    step = max(1, len(residual) // n_instant)
    columns: dict[str, Callable[[Motion], Floats]] = {"t": lambda motion: motion.t}
    for j in range(n_joint):
        columns |= {
            f"q{j + 1}": lambda motion, j=j: motion.q[:, j],  # type: ignore[misc]
            f"dq{j + 1}": lambda motion, j=j: motion.dq[:, j],  # type: ignore[misc]
            f"ddq{j + 1}": lambda motion, j=j: motion.ddq[:, j],  # type: ignore[misc]
        }
    found = []
    for j in range(n_joint):
        moving = np.flatnonzero(np.isfinite(residual[:, j]))[::step]
        if len(moving) < 100:
            continue
        r = scipy.stats.rankdata(residual[moving, j], method="ordinal")
        shifts = rng.integers(len(r) // 20, len(r) - len(r) // 20, n_shifted)
        for name, column in columns.items():
            order = np.argsort(np.concatenate([column(motion) for motion in motions])[moving], kind="stable")
            xi = _xi(r[order])
            chance = np.array([_xi(np.roll(r, shift)[order]) for shift in shifts])
            p = float((1 + np.count_nonzero(chance >= xi)) / (1 + n_shifted))
            found.append(Dependence(j + 1, name, xi, p))
    return found


def _xi(ranks: Floats) -> float:
    n = len(ranks)
    return float(1.0 - 3.0 * np.abs(np.diff(ranks)).sum() / (n * n - 1.0))


def typical(squares: Floats, n_effective: Floats) -> float:
    """Return the geometric mean of what trials are left with, in units of noise.

    Parameters
    ----------
    squares, n_effective : (n_trial,)
        chi2 of each, and its expectation for noise alone.
    """
    return float(np.exp(np.mean(np.log(np.maximum(squares / n_effective, TINY)))))


class CrossValidation:
    """Every eighth trial to judge, all others to fit, in turn.

    A function that is a little off, or knows nothing of the speed that one trial goes at, would leave much there
    and little in all others, so what counts is what trials are typically left with.
    """

    def __init__(self, regression: Regression, final: Candidate, folds: int = 8) -> None:
        self._regression, self._model = regression, final.model
        rows = [regression.rows(final.model, motion) for motion in regression.motions]
        n_base = rows[0].design.shape[1] - final.model.n_column
        # What the causes were found to do stays as it is: an event in one trial cannot be learnt from others.
        self._known = [one.design[:, :n_base] for one in rows]
        self._target = [one.target.ravel() - one.design[:, n_base:] @ final.x[n_base:] for one in rows]
        both = [np.column_stack(pair) for pair in zip(self._known, self._target, strict=True)]
        self._products = np.array([one.T @ one for one in both])
        freed = regression.weighting.freed
        self._again = [freed(motion, one) for motion, one in zip(self._motions, both, strict=True)]
        self._functions = BasisFunctions(regression.motions, regression.arm.n_joint)
        n_effective = [regression.weighting.n_effective(motion) for motion in regression.motions]
        self._n_effective = np.array(n_effective, dtype=np.float64)
        self._fold = np.arange(len(n_effective)) % folds
        #: Sum of squares that the model leaves in every trial with base parameters of the others, (n_trial,).
        self.held_out = self._held_out_chi2(self._products)
        self.typical_chi2 = typical(self.held_out, self._n_effective)

    def typical(self, some: Sequence[str], joint: int, smooth: bool = False) -> float:
        """Return the typical chi2 of held-out trials with a function of some variables, in units of noise.

        Parameters
        ----------
        some : sequence of str
        joint : int
            At whose torque, from 0.
        smooth : bool
            Whether the function may be a polynomial, or a product of simple functions, where that leaves less.
        """
        return typical(self.squares(some, joint, smooth), self._n_effective)

    def squares(self, some: Sequence[str], joint: int, smooth: bool = False) -> Floats:
        """Return the sum of squares that the same leaves in every trial, none of which it has seen, (n_trial,)."""
        splines = self._judged([self._functions.b_splines(motion, some) for motion in self._motions], joint)
        if not smooth:
            return splines
        powers = [self._functions.polynomials(motion, some) for motion in self._motions]
        single = self._terms_judged(some, joint)
        tried = [splines, self._judged(powers, joint), *single.T]
        return min(tried, key=lambda one: typical(one, self._n_effective))

    def formula(self, some: Sequence[str], joint: int, gain: float) -> str:
        """Return the product of simple functions of the variables that explains most, if it is telling."""
        typical_each = np.array([typical(one, self._n_effective) for one in self._terms_judged(some, joint).T])
        if not self.typical_chi2 - typical_each.min() > (1.0 - 2.0 * UNEXPLAINED) * gain:
            return ""
        k = int(np.argmin(typical_each))
        filtered_at = self._regression.weighting.filtered_at
        column = [
            filtered_at(motion, joint, symbolic_terms(motion, some)[:, k : k + 1]) for motion in self._motions
        ]
        design = np.hstack([np.vstack(self._known), np.vstack(column)])
        factor = scaled_lstsq(design, np.concatenate(self._target))[-1]
        return f"tau{joint + 1} has {factor:+.3g} {spellings(some)[k]}"

    @property
    def _motions(self) -> list[Motion]:
        return self._regression.motions

    def _judged(self, features: Sequence[Floats], joint: int) -> Floats:
        """Return the held-out chi2 of functions of all features at a joint, fitted with the base parameters."""
        parts = zip(self._motions, features, self._again, strict=True)
        sums = [_Sums.of(self._regression, motion, joint, one, again) for motion, one, again in parts]
        whole = np.array([one.bordered(products) for one, products in zip(sums, self._products, strict=True)])
        return self._held_out_chi2(whole)

    def _held_out_chi2(self, whole: Floats) -> Floats:
        """Return the held-out chi2 of columns of which all products are known, the target's among them."""
        target = self._products.shape[1] - 1  # base parameters, the target, and what was added behind it
        design = np.delete(np.arange(whole.shape[1]), target)
        grams, rhs_parts = whole[:, design[:, None], design], whole[:, design, target]
        size = np.sqrt(np.maximum(np.einsum("kii->i", grams), 0.0))  # rounding makes nothing less than that
        size[size == 0.0] = 1.0
        # A product of splines has cells that some trials hardly visit: what it makes there is held towards zero.
        held = np.where(np.arange(len(size)) < target, ROUNDED, NEGLIGIBLE**2)
        squares, fold = whole[:, target, target].copy(), self._fold
        for k in range(fold.max() + 1):
            G = grams[fold != k].sum(axis=0) / np.outer(size, size)
            G[np.diag_indices(len(G))] += held
            x = np.linalg.solve(G, rhs_parts[fold != k].sum(axis=0) / size) / size
            squares[fold == k] += x @ (grams[fold == k] @ x).T - 2.0 * rhs_parts[fold == k] @ x
        return squares

    def _terms_judged(self, some: Sequence[str], joint: int) -> Floats:
        """Return the held-out chi2 of every symbolic term fitted with the base, (n_trial, n_product).

        One column in addition to many known ones: its factor is what it has in common with the target once the
        known ones are taken off both.
        """
        parts = zip(self._motions, self._again, strict=True)
        sums = [
            _Sums.of(self._regression, motion, joint, symbolic_terms(motion, some), again)
            for motion, again in parts
        ]
        K, p = self._products[:, :-1, :-1], self._products[:, :-1, -1]
        U = np.array([one.across[:, :-1].T for one in sums])
        V, w = np.array([one.squares for one in sums]), np.array([one.across[:, -1] for one in sums])
        size = np.sqrt(np.einsum("kii->i", K))
        size[size == 0.0] = 1.0
        squares, fold = np.repeat(self._products[:, -1:, -1], V.shape[1], axis=1), self._fold
        for k in range(fold.max() + 1):
            learnt = fold != k
            G = K[learnt].sum(axis=0) / np.outer(size, size)
            G[np.diag_indices(len(G))] += ROUNDED
            both = np.column_stack([p[learnt].sum(axis=0), U[learnt].sum(axis=0)])
            alone = np.linalg.solve(G, both / size[:, None]) / size[:, None]
            rest = V[learnt].sum(axis=0) - np.einsum("ij,ij->j", both[:, 1:], alone[:, 1:])
            common = w[learnt].sum(axis=0) - both[:, 1:].T @ alone[:, 0]
            factor = np.where(
                rest > ROUNDED * V[learnt].sum(axis=0), common / np.where(rest > 0.0, rest, 1.0), 0.0
            )
            x = alone[:, :1] - alone[:, 1:] * factor
            for i in np.flatnonzero(~learnt):
                squares[i] += np.einsum("ij,ij->j", x, K[i] @ x) + factor**2 * V[i]
                squares[i] += 2.0 * (factor * np.einsum("ij,ij->j", U[i], x) - p[i] @ x - factor * w[i])
        return squares


@dataclass(frozen=True)
class _Sums:
    """Products of features at one joint in a trial, filtered: W'W - Z'Z with each other, across with the rest."""

    W: Floats
    Z: Floats
    across: Floats

    @classmethod
    def of(cls, regression: Regression, motion: Motion, joint: int, features: Floats, again: Floats) -> "_Sums":
        """Return those with rows that have been freed once more."""
        weighting = regression.weighting
        columns = Columns(weighting, motion, weighting.whitened_at(motion, joint, features))
        return cls(columns.white, columns.lost, columns.white.T @ again)

    @property
    def squares(self) -> Floats:
        """Of each feature, (n_feature,)."""
        return np.asarray(np.einsum("ij,ij->j", self.W, self.W) - np.einsum("ij,ij->j", self.Z, self.Z))

    def bordered(self, products: Floats) -> Floats:
        """Return these with the products of the rest in front of them, a symmetric matrix."""
        return np.block([[products, self.across.T], [self.across, self.W.T @ self.W - self.Z.T @ self.Z]])
