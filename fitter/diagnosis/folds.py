"""Functions of some variables, fitted to most trials and judged on the others."""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.agreement import typical
from fitter.diagnosis.functions import Functions
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.products import products, spelled
from fitter.diagnosis.regression import Regression, scaled_lstsq
from fitter.diagnosis.screening import Candidate

#: How strongly a function's factors are held towards zero, in units of a column's own sum of squares; those of a
#: single formula are not, as little as the base parameters.
_RIDGE, _EXACT = 1e-4, 1e-12
#: A column of which base parameters leave no more than this share says nothing that they don't.
_TOLD = 1e-9
_FOLDS = 8
#: A formula is told if it explains this share of what the function does.
_TELLING = 0.9


class Folds:
    """Every eighth trial to judge, all others to fit, in turn.

    A function that is a little off, or knows nothing of the speed that one trial goes at, would leave much there
    and little in all others, so what counts is what trials are typically left with.
    """

    def __init__(self, regression: Regression, final: Candidate) -> None:
        self._regression, self._model = regression, final.model
        rows = [regression.rows(final.model, motion) for motion in regression.motions]
        n_base = rows[0].design.shape[1] - final.model.n_column
        # What the causes were found to do stays as it is: an event in one trial cannot be learnt from others.
        self._known = [one.design[:, :n_base] for one in rows]
        self._target = [one.target.ravel() - one.design[:, n_base:] @ final.x[n_base:] for one in rows]
        self._functions = Functions(regression.motions, regression.arm.n_joint)
        told = [regression.weighting.told(motion) for motion in regression.motions]
        self._told = np.array(told, dtype=np.float64)
        self._fold = np.arange(len(told)) % _FOLDS
        self.left = self._judged([np.zeros((len(one), 0)) for one in self._target])

    def typical(self, some: Sequence[str], joint: int, smooth: bool = False) -> float:
        """Return what a function of some variables leaves in trials it has not seen, in units of noise.

        Parameters
        ----------
        some : sequence of str
        joint : int
            At whose torque, from 0.
        smooth : bool
            Whether the function may be a polynomial, or a product of simple functions, where that leaves less.
        """
        hats = self._judged(
            [self._filtered(motion, self._functions.hats(motion, some), joint) for motion in self._motions]
        )
        if not smooth:
            return hats
        polynomials = self._judged(
            [self._filtered(motion, self._functions.polynomials(motion, some), joint) for motion in self._motions]
        )
        return min(hats, polynomials, float(self._products_judged(some, joint).min()))

    def formula(self, some: Sequence[str], joint: int, gain: float) -> str:
        """Return the product of simple functions of the variables that explains most, if it is telling."""
        left = self._products_judged(some, joint)
        if not self.left - left.min() > _TELLING * gain:
            return ""
        k = int(np.argmin(left))
        column = [self._filtered(motion, products(motion, some)[:, k : k + 1], joint) for motion in self._motions]
        design = np.hstack([np.vstack(self._known), np.vstack(column)])
        factor = scaled_lstsq(design, np.concatenate(self._target))[-1]
        return f"tau{joint + 1} has {factor:+.3g} {spelled(some)[k]}"

    @property
    def _motions(self) -> list[Motion]:
        return self._regression.motions

    def _filtered(self, motion: Motion, features: Floats, joint: int) -> Floats:
        return self._regression.weighting.filtered_at(motion, joint, features)

    def _judged(self, added: Sequence[Floats]) -> float:
        designs = [np.hstack([known, more]) for known, more in zip(self._known, added, strict=True)]
        grams = np.array([one.T @ one for one in designs])
        pulls = np.array([one.T @ target for one, target in zip(designs, self._target, strict=True)])
        size = np.sqrt(np.einsum("kii->i", grams))
        size[size == 0.0] = 1.0
        # A product of splines has cells that some trials hardly visit: what it makes there is held towards zero.
        held = np.where(np.arange(len(size)) < self._known[0].shape[1], _EXACT, _RIDGE)
        squares, fold = np.empty(len(designs)), self._fold
        for k in range(fold.max() + 1):
            G = grams[fold != k].sum(axis=0) / np.outer(size, size)
            G[np.diag_indices(len(G))] += held
            x = np.linalg.solve(G, pulls[fold != k].sum(axis=0) / size) / size
            for i in np.flatnonzero(fold == k):
                squares[i] = np.sum((self._target[i] - designs[i] @ x) ** 2)
        return typical(squares, self._told)

    def _products_judged(self, some: Sequence[str], joint: int) -> Floats:
        """Return what every product of simple functions leaves, each with the base parameters only, (n_product,).

        One column beside many known ones: its factor is what it has in common with the target once the known
        ones are taken off both.
        """
        columns = [self._filtered(motion, products(motion, some), joint) for motion in self._motions]
        pairs = list(zip(self._known, columns, self._target, strict=True))
        K = np.array([known.T @ known for known, _, _ in pairs])
        U = np.array([known.T @ column for known, column, _ in pairs])
        V = np.array([np.einsum("ij,ij->j", column, column) for _, column, _ in pairs])
        p = np.array([known.T @ target for known, _, target in pairs])
        w = np.array([column.T @ target for _, column, target in pairs])
        size = np.sqrt(np.einsum("kii->i", K))
        size[size == 0.0] = 1.0
        squares, fold = np.empty((len(pairs), V.shape[1])), self._fold
        for k in range(fold.max() + 1):
            learnt = fold != k
            G = K[learnt].sum(axis=0) / np.outer(size, size)
            G[np.diag_indices(len(G))] += _EXACT
            both = np.column_stack([p[learnt].sum(axis=0), U[learnt].sum(axis=0)])
            alone = np.linalg.solve(G, both / size[:, None]) / size[:, None]
            rest = V[learnt].sum(axis=0) - np.einsum("ij,ij->j", both[:, 1:], alone[:, 1:])
            common = w[learnt].sum(axis=0) - both[:, 1:].T @ alone[:, 0]
            factor = np.where(rest > _TOLD * V[learnt].sum(axis=0), common / np.where(rest > 0.0, rest, 1.0), 0.0)
            x = alone[:, :1] - alone[:, 1:] * factor
            for i in np.flatnonzero(fold == k):
                known, column, target = pairs[i]
                squares[i] = np.sum((target[:, None] - known @ x - column * factor) ** 2, axis=0)
        return np.array([typical(one, self._told) for one in squares.T])
