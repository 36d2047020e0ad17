"""Functions of some variables, fitted to most trials and judged on the others."""

from collections.abc import Callable, Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.agreement import typical
from fitter.diagnosis.functions import Functions, variable
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression, scaled_lstsq
from fitter.diagnosis.screening import Candidate

#: How strongly a function's factors are held towards zero, in units of a column's own sum of squares; those of a
#: single formula are not, as little as the base parameters.
_RIDGE, _EXACT = 1e-4, 1e-12
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
        self.left = self._judged([np.zeros((len(one), 0)) for one in self._target])

    def typical(self, some: Sequence[str], joint: int, smooth: bool = False) -> float:
        """Return what a function of some variables leaves in trials it has not seen, in units of noise.

        Parameters
        ----------
        some : sequence of str
        joint : int
            At whose torque, from 0.
        smooth : bool
            Whether the function may be a polynomial, too, where that leaves less.
        """
        kinds = [self._functions.hats, self._functions.polynomials][: 2 if smooth else 1]
        return min(
            self._judged([self._filtered(motion, kind(motion, some), joint) for motion in self._motions])
            for kind in kinds
        )

    def formula(self, some: Sequence[str], joint: int, gain: float) -> str:
        """Return the product of simple functions of the variables that explains most, if it is telling."""
        best, text = 0.0, ""
        for shapes in _products(some):
            columns, parts = [], []
            for motion in self._motions:
                column = np.ones(len(motion.t))
                for name, shape in zip(some, shapes, strict=True):
                    column = column * _SHAPES[shape](variable(motion, name))
                columns.append(self._filtered(motion, column[:, None], joint))
            parts = [_spelled(name, shape) for name, shape in zip(some, shapes, strict=True)]
            explained = self.left - self._judged(columns, _EXACT)
            if explained > best:
                A, y = np.vstack(self._known), np.concatenate(self._target)
                factor = scaled_lstsq(np.hstack([A, np.vstack(columns)]), y)[-1]
                best, text = explained, f"tau{joint + 1} has {factor:+.3g} {' '.join(parts)}"
        return text if best > _TELLING * gain else ""

    @property
    def _motions(self) -> list[Motion]:
        return self._regression.motions

    def _filtered(self, motion: Motion, features: Floats, joint: int) -> Floats:
        rows = np.zeros((len(features), self._regression.arm.n_joint, features.shape[1]))
        rows[:, joint] = features
        return self._regression.weighting.filtered(motion, rows).reshape(-1, features.shape[1])

    def _judged(self, added: Sequence[Floats], ridge: float = _RIDGE) -> float:
        designs = [np.hstack([known, more]) for known, more in zip(self._known, added, strict=True)]
        grams = np.array([one.T @ one for one in designs])
        pulls = np.array([one.T @ target for one, target in zip(designs, self._target, strict=True)])
        size = np.sqrt(np.einsum("kii->i", grams))
        size[size == 0.0] = 1.0
        # A product of splines has cells that some trials hardly visit: what it makes there is held towards zero.
        held = np.where(np.arange(len(size)) < self._known[0].shape[1], _EXACT, ridge)
        squares, fold = np.empty(len(designs)), np.arange(len(designs)) % _FOLDS
        for k in range(min(_FOLDS, len(designs))):
            G = grams[fold != k].sum(axis=0) / np.outer(size, size)
            G[np.diag_indices(len(G))] += held
            x = np.linalg.solve(G, pulls[fold != k].sum(axis=0) / size) / size
            for i in np.flatnonzero(fold == k):
                squares[i] = np.sum((self._target[i] - designs[i] @ x) ** 2)
        return typical(squares, self._told)


_SHAPES: dict[str, Callable[[Floats], Floats]] = {
    "": lambda x: x,
    "sin": np.sin,
    "cos": np.cos,
    "^2": np.square,
    "^3": lambda x: x**3,
    "||": lambda x: x * np.abs(x),
}


def _products(some: Sequence[str]) -> list[tuple[str, ...]]:
    choices: list[tuple[str, ...]] = [()]
    for name in some:
        own = ("",) if name.startswith("sign(") else ("", "sin", "cos", "^2", "^3", "||")
        choices = [(*before, shape) for before in choices for shape in own]
    return choices


def _spelled(name: str, shape: str) -> str:
    if shape in ("sin", "cos"):
        return f"{shape}({name})"
    return f"{name}|{name}|" if shape == "||" else f"{name}{shape}"
