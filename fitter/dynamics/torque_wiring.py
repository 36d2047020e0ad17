"""Torque columns that were exchanged or have the wrong sign: no arm that can exist moves as they say.

The torque equation ``W p = tau`` is linear, so every way of wiring the columns (whose torque is in which column,
with which sign) has a least-squares answer that costs next to nothing once ``W_i^T tau_k`` is there for every
joint i and column k. Turning all signs turns the sign of every mass, which no residual shows but physics does:
ways are compared by what the best arm that can exist leaves of the torque.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations, product

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import regressor, standard_parameters
from fitter.data.first_rest import REST_SPEED
from fitter.data.trials import Trial
from fitter.dynamics.learned_torque import has_unknown_target, learned_torque
from fitter.dynamics.physical import physical_optimum
from fitter.dynamics.torque_problem import torque_problem
from fitter.dynamics.torque_sums import TorqueSums
from limbcal.errors import NotConverged, NotIdentifiable

#: Samples of a trial that are enough to tell ways of wiring apart.
_SAMPLES = 1000
#: Up to this many joints all permutations and signs are tried; beyond, one exchange or one sign at a time.
_ALL_WAYS = 3
#: Of all ways those with the least free residual get their possible arm.
_SHORTLIST = 6
#: Largest residual of the likely wiring's best feasible arm, as a fraction of that of the columns as given:
#: with Gaussian residuals and 30 effective samples a likelihood ratio of more than 10⁴ (0.5^-15).
_FAR_LESS = 0.5


@dataclass(frozen=True)
class Wiring:
    """A way of reading torque columns.

    Attributes
    ----------
    column : tuple of int
        For every joint, the column (from 0) that its torque stands in.
    sign : tuple of int
        For every joint, 1 or −1.
    left : float
        Share of the torque's power that the best arm that can exist leaves, 0..1.
    """

    column: tuple[int, ...]
    sign: tuple[int, ...]
    left: float

    @property
    def sentence(self) -> str:
        """What to ask the user."""
        exchanged = [f"tau{k + 1} as that of joint {i + 1}" for i, k in enumerate(self.column) if i != k]
        turned = [f"tau{self.column[i] + 1}" for i, sign in enumerate(self.sign) if sign < 0]
        done = []
        if turned:
            done.append(f"the sign of {' and '.join(turned)} turned")
        if exchanged:
            done.append(f"{' and '.join(exchanged)}")
        asked = []
        if turned:
            asked.append(f"{'is' if len(turned) == 1 else 'are'} {' and '.join(turned)} the load's?")
        if exchanged:
            names = sorted({f"tau{k + 1}" for i, k in enumerate(self.column) if i != k})
            asked.append(f"are {' and '.join(names)} exchanged?")
        return (
            "masses come out negative or otherwise impossible; with "
            f"{' and '.join(done)} they are possible: {' '.join(asked)}"
        )


@dataclass(frozen=True)
class WiringCheck:
    """What the columns as given and the best other way of wiring them leave of the torque.

    Attributes
    ----------
    free, possible : float
        Share of the torque's power that the best numbers and the best arm that can exist leave, 0..1, columns as
        they were given.
    better : Wiring or None
        Another way under which an arm that can exist leaves far less.
    """

    free: float
    possible: float
    better: Wiring | None


def check_wiring(arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> WiringCheck | None:
    """Compare the ways of wiring torque columns.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity.
    base : BaseParameters
    trials : sequence of Trial
        Where a law drives the arm its torque is taken, and no other way of wiring is tried.

    Returns
    -------
    WiringCheck or None
        None where the torque tells nothing.
    """
    n = arm.n_joint
    gram, moment, power, count = _cross_sums(arm, base, trials)
    if not power.sum() > 0.0 or not np.any(gram):
        return None
    prior = base.combination @ standard_parameters(arm)

    def sums_of(column: Sequence[int], sign: Sequence[int]) -> TorqueSums:
        own = np.array([sign[i] * moment[i, column[i]] for i in range(n)])
        return TorqueSums(
            gram=gram[None],
            moment=own[None],
            power=power[list(column)][None],
            row=np.zeros((1, *own.shape)),
            torque=np.zeros((1, n)),
            count=count[None],
            trial=np.zeros(1, dtype=np.intp),
            samples=int(count.max()),
        )

    def free_left(column: Sequence[int], sign: Sequence[int]) -> float:
        try:
            return float(torque_problem(sums_of(column, sign), prior).rest / power.sum())
        except NotIdentifiable:
            return 1.0

    def possible_left(column: Sequence[int], sign: Sequence[int]) -> float:
        problem = torque_problem(sums_of(column, sign), prior)
        try:
            genes, _ = physical_optimum(arm, base, problem)
        except NotConverged:
            return 1.0
        return float(problem.cost(genes[None])[0] / power.sum())

    straight, upright = tuple(range(n)), (1,) * n
    free = free_left(straight, upright)
    possible = possible_left(straight, upright) if free < 1.0 else 1.0
    ways = [] if arm.control.law != "measured" else list(_ways(n))
    ranked = sorted(
        (free_left(*way), sum(map(int.__ne__, way[0], straight)), way[1].count(-1), way) for way in ways
    )
    better: Wiring | None = None
    for left, _, _, (column, sign) in ranked[:_SHORTLIST]:
        limit = _FAR_LESS * possible if better is None else 0.99 * better.left
        if left < limit and (found := possible_left(column, sign)) < limit:
            better = Wiring(column, sign, found)
    return WiringCheck(free, possible, better)


def _ways(n: int) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Iterate over the ways of wiring that are tried beside the columns as given."""
    straight, upright = tuple(range(n)), (1,) * n
    if n <= _ALL_WAYS:
        for column, sign in product(permutations(range(n)), product((1, -1), repeat=n)):
            if (column, sign) != (straight, upright):
                yield column, sign
        return
    yield straight, (-1,) * n
    for j in range(n):
        yield straight, tuple(-1 if i == j else 1 for i in range(n))
    for a, b in combinations(range(n), 2):
        yield tuple(b if i == a else a if i == b else i for i in range(n)), upright


def _cross_sums(arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> tuple[Floats, Floats, Floats, Floats]:
    """Return gram (joint, b, b), moment (joint, column, b), power (column,), count (joint,) of thinned trials."""
    n, n_base = arm.n_joint, len(base.independent)
    gram, moment = np.zeros((n, n_base, n_base)), np.zeros((n, n, n_base))
    power, count = np.zeros((2, n))
    for trial in trials:
        if has_unknown_target(arm, trial):
            continue
        some = slice(None, None, max(1, len(trial.q) // _SAMPLES))
        q, dq, ddq, tau = (values[some] for values in (trial.q, trial.dq, trial.ddq, learned_torque(arm, trial)))
        rows = regressor(arm, q, dq, ddq)[..., base.independent]
        moving = ((np.abs(dq) > REST_SPEED) & trial.counted[some]).all(axis=1)
        rows, tau = rows[moving], tau[moving]
        gram += np.einsum("sja,sjb->jab", rows, rows)
        moment += np.einsum("sja,sk->jka", rows, tau)
        power += np.sum(tau**2, axis=0)
        count += len(tau)
    return gram, moment, power, count
