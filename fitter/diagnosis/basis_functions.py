"""Functions of some variables of a motion, as columns: linear B-splines, polynomials and symbolic terms.

Between the few places that some trials go to, tensor products of B-splines do not extrapolate; a polynomial of
few degrees goes on from the one to the other, but has no kink. Products of simple functions are formulas that one
factor makes a torque of: if they are right, they know what to expect where no trial was.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy

from arm.model import Floats
from fitter.diagnosis.least_squares import ROUNDED
from fitter.diagnosis.motion import Motion

#: B-splines a variable, and total degree of polynomials, by the number of variables. With fewer of them
#: it is the finer one, so that a further variable never wins for being one more.
_N_SPLINE = {1: 8, 2: 6, 3: 4}
_DEGREE = {1: 7, 2: 5, 3: 4}


_SHAPES: dict[str, Callable[[Floats], Floats]] = {
    "{}": lambda x: x,
    "sin({})": np.sin,
    "cos({})": np.cos,
    "{}^2": np.square,
    "{}^3": lambda x: x**3,
    "|{}|": np.abs,
    "{0}|{0}|": lambda x: x * np.abs(x),
}


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


class BasisFunctions:
    """Columns of functions of some variables, the same for all motions of a run.

    Parameters
    ----------
    motions : sequence of Motion
        Over whose range the functions reach.
    n_joint : int
    """

    def __init__(self, motions: Sequence[Motion], n_joint: int) -> None:
        self._span = {name: _range([variable(motion, name) for motion in motions]) for name in names(n_joint)}
        self._known: dict[tuple[int, str, int], Floats] = {}

    def b_splines(self, motion: Motion, some: Sequence[str]) -> Floats:
        """Return the tensor product of linear B-splines of some variables, (n_sample, n_function)."""
        columns = np.ones((len(motion.t), 1))
        for name in some:
            one = self._b_splines(motion, name, _N_SPLINE[len(some)])
            columns = (columns[:, :, None] * one[:, None, :]).reshape(len(columns), -1)
        return columns

    def polynomials(self, motion: Motion, some: Sequence[str]) -> Floats:
        """Return all products of Legendre polynomials up to a degree of all together, (n_sample, n_function)."""
        most = _DEGREE[len(some)]
        powers = [self._powers(motion, name, most) for name in some]
        kept = [
            degrees
            for degrees in product(*(range(one.shape[1]) for one in powers))
            if sum(degree for degree, name in zip(degrees, some, strict=True) if not _is_sign(name)) <= most
        ]
        columns = np.ones((len(motion.t), len(kept)))
        for one, chosen in zip(powers, zip(*kept, strict=True), strict=True):
            columns *= one[:, chosen]
        return columns

    def _b_splines(self, motion: Motion, name: str, count: int) -> Floats:
        key = motion.number, name, count
        if key not in self._known:
            values = variable(motion, name)
            low, high = self._span[name]
            if _is_sign(name):
                self._known[key] = np.stack([np.ones(len(values)), values], axis=1)
            else:
                knots = np.linspace(low, high, count)
                if name.startswith("dq") and low < 0.0 < high:  # friction has its kink where a joint reverses
                    knots[1 + np.argmin(np.abs(knots[1:-1]))] = 0.0
                knots = np.concatenate([[low], knots, [high]])
                at = np.clip(values, low, high - ROUNDED * (high - low))
                design = scipy.interpolate.BSpline.design_matrix(at, knots, 1)
                self._known[key] = np.asarray(design.toarray(), dtype=np.float64)
        return self._known[key]

    def _powers(self, motion: Motion, name: str, most: int) -> Floats:
        values = variable(motion, name)
        if _is_sign(name):
            return np.stack([np.ones(len(values)), values], axis=1)
        low, high = self._span[name]
        scaled = np.clip(2.0 * (values - low) / (high - low) - 1.0, -1.0, 1.0)
        return np.asarray(np.polynomial.legendre.legvander(scaled, most), dtype=np.float64)


def _is_sign(name: str) -> bool:
    return name.startswith("sign(")


def _range(columns: Sequence[Floats]) -> tuple[float, float]:
    low, high = np.quantile(np.concatenate(columns), [0.002, 0.998])
    return float(low), float(max(high, low + ROUNDED))


def symbolic_terms(motion: Motion, some: Sequence[str]) -> Floats:
    """Return all products along a motion, (n_sample, n_product)."""
    columns = np.ones((len(motion.t), 1))
    for name in some:
        values = variable(motion, name)
        one = np.stack([_SHAPES[shape](values) for shape in _shapes(name)], axis=1)
        columns = (columns[:, :, None] * one[:, None, :]).reshape(len(columns), -1)
    return columns


def spellings(some: Sequence[str]) -> list[str]:
    """Return how they are written, in the same order."""
    choices = product(*([shape.format(name) for shape in _shapes(name)] for name in some))
    return [" ".join(parts) for parts in choices]


def _shapes(name: str) -> list[str]:
    return ["{}"] if name.startswith("sign(") else list(_SHAPES)


@dataclass(frozen=True)
class Dependence:
    """How much a joint's remaining torque depends on one variable.

    Attributes
    ----------
    joint : int
        From 1.
    variable : str
    xi : float
        0 for independence, 1 for a function of the variable.
    p : float
        How often chance gives as much.
    """

    joint: int
    variable: str
    xi: float
    p: float


@dataclass(frozen=True)
class Discrepancy:
    """What no effect of the catalogue explains, described.

    Attributes
    ----------
    explained : float
        Fraction of the trials' typical chi2 that a function explains where it was not fitted, 0 to 1.
    gain : float
        The same in units of noise.
    white : bool
    depends_on : tuple of str
        Such as ``q2``, ``sign(dq1)``, ``t``.
    joint : int
        At whose torque, from 1; 0 where nothing was found.
    formula : str
    dependences : list of Dependence
        Of the remaining torque on each variable alone, with a permutation test.
    trial_offsets_N_m : tuple of float
        Standard deviation, at each joint, of a constant torque that every trial lacks in its own way.
    """

    explained: float
    gain: float
    white: bool
    depends_on: tuple[str, ...]
    joint: int
    formula: str
    dependences: list[Dependence]
    trial_offsets_N_m: tuple[float, ...]
