"""Smooth functions of some variables, fitted to every other trial and judged on the trials between them."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.interpolate import BSpline

from arm.model import Floats
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression, scaled_lstsq
from fitter.diagnosis.screening import Candidate

#: Splines a variable, by how many variables a function has.
_SPLINES = {1: 8, 2: 5, 3: 4}
#: How strongly a function's factors are held towards zero, in units of a column's own sum of squares.
_RIDGE = 1e-3
#: A formula is told if it explains this share of what the function does.
_TELLING = 0.9


def names(n_joint: int) -> list[str]:
    """Return the names of the variables that a remainder may depend on."""
    return [f"{kind}{j + 1}" for kind in ("q", "dq") for j in range(n_joint)] + [
        *(f"sign(dq{j + 1})" for j in range(n_joint)),
        "t",
    ]


def variable(motion: Motion, name: str) -> Floats:
    """Return a variable along a motion, (n_sample,)."""
    if name == "t":
        return motion.t
    if name.startswith("sign("):
        return np.sign(motion.dq[:, int(name[7:-1]) - 1])
    kind, j = name.rstrip("0123456789"), int(name[len(name.rstrip("0123456789")) :]) - 1
    columns: dict[str, Floats] = {"q": motion.q, "dq": motion.dq}
    return columns[kind][:, j]


class Folds:
    """Every other trial to fit, the others to judge, and the other way round."""

    def __init__(self, regression: Regression, final: Candidate) -> None:
        self._regression, self._model = regression, final.model
        rows = [regression.rows(final.model, motion) for motion in regression.motions]
        n_base = rows[0].base.shape[2]
        # What the causes were found to do stays as it is: an event in one trial cannot be learnt from others.
        self._known = [one.design[:, :n_base] for one in rows]
        self._target = [one.target.ravel() - one.design[:, n_base:] @ final.x[n_base:] for one in rows]
        self._span = {
            name: self._range([variable(motion, name) for motion in regression.motions])
            for name in names(regression.arm.n_joint)
        }
        self._fitted: dict[tuple[str, int], list[Floats]] = {}
        self.left = self._judged([np.zeros((len(one), 0)) for one in self._target])

    def squares(self, some: Sequence[str], joint: int) -> float:
        """Return the sum of squares that a function of some variables leaves in trials it has not seen."""
        return self._judged(
            [self._filtered(motion, self._function(motion, some), joint) for motion in self._motions]
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
            explained = self.left - self._judged(columns)
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

    def _judged(self, added: Sequence[Floats]) -> float:
        designs = [np.hstack([known, more]) for known, more in zip(self._known, added, strict=True)]
        size = np.sqrt(sum(np.einsum("ij,ij->j", one, one) for one in designs))
        size[size == 0.0] = 1.0
        total = 0.0
        for fold in (0, 1):
            A = np.vstack(designs[fold::2])
            x = _held_small(A, np.concatenate(self._target[fold::2]), self._known[0].shape[1], size)
            for design, target in zip(designs[1 - fold :: 2], self._target[1 - fold :: 2], strict=True):
                total += float(np.sum((target - design @ x) ** 2))
        return total

    def _function(self, motion: Motion, some: Sequence[str]) -> Floats:
        product = np.ones((len(motion.t), 1))
        for name in some:
            one = self._splines(motion, name, _SPLINES[len(some)])
            product = (product[:, :, None] * one[:, None, :]).reshape(len(product), -1)
        return product

    def _splines(self, motion: Motion, name: str, count: int) -> Floats:
        values = variable(motion, name)
        if name.startswith("sign("):
            return np.stack([np.ones(len(values)), values], axis=1)
        low, high = self._span[name]
        degree = min(3, count - 1)
        inner = np.linspace(low, high, count - degree + 1)
        knots = np.concatenate([[low] * degree, inner, [high] * degree])
        at = np.clip(values, low, high - 1e-9 * (high - low))
        return np.asarray(BSpline.design_matrix(at, knots, degree).toarray(), dtype=np.float64)

    @staticmethod
    def _range(columns: Sequence[Floats]) -> tuple[float, float]:
        everything = np.concatenate(columns)
        low, high = np.quantile(everything, [0.002, 0.998])
        return float(low), float(max(high, low + 1e-9))


def _held_small(A: Floats, y: Floats, n_known: int, size: Floats) -> Floats:
    """Return the least-squares answer with all but the first columns' factors held a little towards zero.

    A product of splines has cells that these trials hardly visit, though others do, and what it makes there is
    anybody's guess: ``size`` is the columns' length over all trials.
    """
    G = (A.T @ A) / np.outer(size, size)
    G[np.diag_indices(len(G))] += np.where(np.arange(len(G)) < n_known, 1e-12, _RIDGE)
    return np.asarray(np.linalg.solve(G, (A.T @ y) / size) / size, dtype=np.float64)


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
