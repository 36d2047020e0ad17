"""Base parameters and gains found together, by least squares to begin with and then with instrumental variables.

Least squares on the law's equation has noise in nearly every column and is drawn towards small gains or small
masses, according to which column is taken for the right-hand side. Instrumental variables lack that noise: columns
of the simulated motion of the arm and the law that were found so far, driven by the target, which is known.
Whatever is wrong with them costs precision and shifts nothing (Söderström and Stoica 1983; for arms Janot,
Vandanjon and Gautier 2014).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters, with_base_values
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from fitter.controller.instrumental_variables import InstrumentalVariables
from fitter.controller.law_ambiguity import Ambiguity, LawNullSpace
from fitter.controller.law_columns import LawColumns
from fitter.controller.law_equations import LawEquations
from fitter.search.standard_errors import sandwich_covariance
from fitter.search.whitened import whiten
from limbcal.errors import NotIdentifiable

#: Instrumental variables are renewed until no parameter moves by more than this fraction of its standard error, or
#: of itself.
_SETTLED, _ROUNDING = 0.02, 1e-9
_ROUNDS = 15
#: Blocks of consecutive equations of a trial, whose scores give the covariance.
_BLOCKS = 100
#: Poses of a trial at which inertia must be positive.
_POSES = 50


@dataclass(frozen=True)
class LawFit:
    """Base parameters and gains of one form of the law.

    Attributes
    ----------
    columns : LawColumns
    values : (n_column,)
    free : (n_free,) int
        Those that were sought.
    covariance : (n_free, n_free)
        NaN where the data is too short for one.
    ambiguity : Ambiguity
        What stays open with what was known.
    torque_share : (n_joint,)
        What the form leaves unexplained of the law's torque, in the mean square, as a share of it; at most 1.
    converged : bool
        Whether the instruments settled; if not, these are the values of least squares.
    """

    columns: LawColumns
    values: Floats
    free: NDArray[np.intp]
    covariance: Floats
    ambiguity: Ambiguity
    torque_share: Floats
    converged: bool

    def std(self) -> Floats:
        """Return standard errors, NaN for what was not sought, (n_column,)."""
        std = np.full(len(self.values), np.nan)
        std[self.free] = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return std

    def identifiable(self, name: str) -> bool:
        """Say whether the data determines a parameter by itself."""
        k = self.columns.names.index(name)
        return bool(k in self.free and not self.ambiguity.open()[k])

    def arm(self, arm: Arm, base: BaseParameters) -> Arm:
        """Return an arm with what was found."""
        moved = with_base_values(arm, base, self.values[: self.columns.n_base])
        return replace(moved, control=self.columns.control(self.values))


@dataclass(frozen=True)
class _Blocks:
    """Sums of products of instruments Z and equations A over blocks: Z^T A, Z^T Z."""

    cross: Floats
    gram: Floats
    trial: NDArray[np.intp]


def fit_law(
    arm: Arm, base: BaseParameters, columns: LawColumns, trials: Sequence[LawEquations], known: Mapping[int, float]
) -> LawFit:
    """Find base parameters and gains from motion, some of them being known.

    Parameters
    ----------
    arm : Arm
        Its values stand for what cannot be determined.
    base : BaseParameters
    columns : LawColumns
    trials : sequence of LawEquations
    known : mapping from index to value

    Raises
    ------
    NotIdentifiable
        If what is known does not fix the common factor, or no joint moved.
    """
    n = len(columns.names)
    rows = [equations.counted(equations.rows[..., :n]) for equations in trials]
    gram = equations_gram(trials)[:, :n, :n]
    if not np.any(gram):
        raise NotIdentifiable("no parameter and no gain can be identified: no joint moved")
    zero = [k for k, value in known.items() if value == 0.0]
    space = LawNullSpace(columns, gram, zero)
    ambiguity = space.given(list(known))
    if ambiguity.leaders:
        names = ", ".join(columns.names[k] for k in ambiguity.leaders)
        given = ", ".join(columns.names[k] for k in known) or "nothing"
        raise NotIdentifiable(
            f"with {given} known, the factor common to {names} and all masses that go with it stays open; "
            "expected a known gain, mass or inertia that is not zero"
        )
    prior = columns.start(base.combination @ standard_parameters(arm), arm.control)
    for k, value in known.items():
        prior[k] = value
    free = np.setdiff1d(np.arange(n), [*known, *ambiguity.folded])
    least_squares = _least_squares(gram.sum(axis=0), space.given(zero), ambiguity, known, prior)
    instruments = InstrumentalVariables(arm, base, columns)
    for start in (least_squares, prior):
        found = _with_instruments(instruments, trials, rows, start, free)
        if found is not None:
            values, covariance = found
            break
    else:
        values = least_squares
        _, covariance = _solved(_blocks(rows, rows), values, free)
    share = torque_shares(columns, gram, values)
    return LawFit(columns, values, free, covariance, ambiguity, share, found is not None)


def _least_squares(
    gram: Floats, nothing_known: Ambiguity, ambiguity: Ambiguity, known: Mapping[int, float], prior: Floats
) -> Floats:
    """Return the values that satisfy the law's equation best, (n_column,).

    The shape of the answer is found with one kp put to 1 for each factor; the factors, and how much of each trade,
    then follow from what is known or held. So the right-hand side is never a noisy acceleration.
    """
    n = len(gram)
    leaders, folded = (np.array(k, dtype=np.intp) for k in (nothing_known.leaders, nothing_known.folded))
    sought = np.setdiff1d(np.arange(n), np.concatenate([leaders, folded]))
    shapes = np.zeros((len(leaders), n))
    shapes[np.arange(len(leaders)), leaders] = 1.0
    whitened = whiten(gram[np.ix_(sought, sought)], -gram[np.ix_(sought, leaders)], np.diag(gram)[leaders].copy())
    shapes[:, sought] = whitened.solve(np.zeros((len(sought), len(leaders)))).T
    ways = np.vstack([shapes, nothing_known.trades])
    given = [*(k for k in known if known[k] != 0.0), *ambiguity.folded]
    values = prior[given]
    size = np.where(values != 0.0, np.abs(values), np.maximum(np.abs(ways[:, given]).max(axis=0), 1e-300))
    amounts = np.linalg.lstsq(ways[:, given].T / size[:, None], values / size, rcond=None)[0]
    answer = np.asarray(amounts @ ways, dtype=np.float64)
    held = [*known, *ambiguity.folded]
    answer[held] = prior[held]
    return answer


def _with_instruments(
    instruments: InstrumentalVariables,
    trials: Sequence[LawEquations],
    rows: Sequence[Floats],
    start: Floats,
    free: NDArray[np.intp],
) -> tuple[Floats, Floats] | None:
    """Return values and covariance, or nothing where the simulated motion leads nowhere."""
    values = start
    somewhere = np.concatenate([equations.q[:: max(1, len(equations.q) // _POSES)] for equations in trials])
    for _ in range(_ROUNDS):
        if not instruments.possible(values, somewhere):
            return None
        simulated = [instruments.rows(values, equations) for equations in trials]
        if not all(np.any(part) for part in simulated):
            return None
        moved, covariance = _solved(_blocks(simulated, rows), values, free)
        std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        step, values = np.abs(moved - values)[free], moved
        allowed = np.maximum(np.nan_to_num(_SETTLED * std), _ROUNDING * np.abs(values[free]).max())
        if np.all(step <= allowed):
            return values, covariance
    return None


def _blocks(instruments: Sequence[Floats], rows: Sequence[Floats]) -> _Blocks:
    cross, gram, trial = [], [], []
    for number, (Z, A) in enumerate(zip(instruments, rows, strict=True)):
        for part in np.array_split(np.arange(len(A)), min(_BLOCKS, len(A))):
            cross.append(np.einsum("tja,tjb->jab", Z[part], A[part]))
            gram.append(np.einsum("tja,tjb->jab", Z[part], Z[part]))
            trial.append(number)
    return _Blocks(np.array(cross), np.array(gram), np.array(trial, dtype=np.intp))


def _solved(sums: _Blocks, values: Floats, free: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Return values for which the equations' residual is square to all instruments, and their covariance."""
    held = values.copy()
    held[free] = 0.0
    cross, gram = sums.cross.sum(axis=1), sums.gram.sum(axis=1)[:, free[:, None], free]
    lhs, rhs = cross.sum(axis=0)[np.ix_(free, free)], -(cross.sum(axis=0) @ held)[free]
    # Columns in units of their size: torques of rad and of rad/s^2 differ by orders.
    size = np.sqrt(np.maximum(np.diag(gram.sum(axis=0)), 1e-300))
    answer = values.copy()
    scaled = lhs / np.outer(size, size)
    answer[free] = np.linalg.lstsq(scaled, rhs / size, rcond=None)[0] / size
    scores = (cross @ answer)[:, free] / size
    whole = gram.sum(axis=0) / np.outer(size, size)
    W = np.linalg.cholesky(whole + 1e-13 * np.eye(len(free))).T
    plain = sandwich_covariance(W, gram / np.outer(size, size), -scores, sums.trial)
    turn = np.linalg.lstsq(scaled, whole, rcond=None)[0]
    return answer, np.asarray(turn @ plain @ turn.T / np.outer(size, size), dtype=np.float64)


def equations_gram(trials: Sequence[LawEquations]) -> Floats:
    """Return sums of products of the columns of some trials' equations, (n_joint, n_column, n_column)."""
    rows = (equations.counted(equations.rows) for equations in trials)
    return np.asarray(sum(np.einsum("tja,tjb->jab", part, part) for part in rows), dtype=np.float64)


def torque_shares(columns: LawColumns, gram: Floats, values: Floats) -> Floats:
    """Return how much of the law's torque the equations leave open, in the mean square, (n_joint,).

    Parameters
    ----------
    columns : LawColumns
    gram : (n_joint, n_column, n_column)
    values : (n_column,)
    """
    law = np.where(np.arange(len(values)) < columns.n_base, 0.0, values)
    residual, torque = (np.maximum(np.einsum("a,jab,b->j", x, gram, x), 0.0) for x in (values, law))
    return np.asarray(np.minimum(residual / np.where(torque > 0.0, torque, 1.0), 1.0), dtype=np.float64)
