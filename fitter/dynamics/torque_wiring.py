"""Torque columns that were exchanged or have the wrong sign, or gravity that has: no such arm can exist.

The torque equation ``W p = tau`` is linear, so every way of wiring the columns (whose torque is in which column,
with which sign) has a least-squares answer that costs next to nothing once ``W_i^T tau_k`` is there for every
joint i and column k. Turning all signs turns the sign of every mass, which no residual shows but physics does:
ways are compared by what the best arm that can exist leaves of the torque. Gravity of the other sign is one more
way: inertia and weight then speak of centres of mass on opposite sides. A single pendulum cannot tell.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations, product

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import regressor, standard_parameters
from fitter.data.standstill import is_moving
from fitter.data.torque_target import has_unknown_target, torque_target
from fitter.data.trial import Trial
from fitter.dynamics.physical import physical_optimum
from fitter.dynamics.torque_problem import TorqueProblem, torque_problem
from fitter.regression_sums.torque_sums import TorqueSums
from limbcal.errors import NotConverged, NotIdentifiable

#: Samples of a trial that are enough to tell ways of wiring apart.
_SAMPLES = 1000
#: Up to this many joints all permutations and signs are tried; beyond, one exchange or one sign at a time.
_ALL_WAYS = 3
#: Of all ways those with the least free residual get their possible arm.
_SHORTLIST = 6
#: Largest residual of the likely wiring's best feasible arm, as a fraction of that of the columns as given: what
#: is significant but less than halves the residual is no exchange.
_FAR_LESS = 0.5
#: Least likelihood ratio of the two, with Gaussian residuals of as many degrees of freedom as the data have.
_ODDS = 1e4


@dataclass(frozen=True)
class Wiring:
    """A way of reading torque columns and gravity.

    Attributes
    ----------
    column : tuple of int
        For every joint, the column (from 0) that its torque stands in.
    sign : tuple of int
        For every joint, 1 or −1.
    residual_share : float
        Share of the torque's power that the best arm that can exist leaves, 0..1.
    falls_up : bool
        Whether gravity is of the other sign than in the arm file.
    """

    column: tuple[int, ...]
    sign: tuple[int, ...]
    residual_share: float
    falls_up: bool = False

    @property
    def sentence(self) -> str:
        """What to ask the user."""
        if self.falls_up:
            return (
                "masses come out negative or otherwise impossible; with gravity the other way round they are "
                "possible: is the sign of gravity_m_s2 in the arm file wrong? Expected the acceleration of free "
                "fall in the base frame, which points down"
            )
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
        changed = ",".join(
            f"tau{i + 1}={'-' if sign < 0 else ''}tau{k + 1}"
            for i, (k, sign) in enumerate(zip(self.column, self.sign, strict=True))
            if i != k or sign < 0
        )
        return (
            "masses come out negative or otherwise impossible; with "
            f"{' and '.join(done)} they are possible: {' '.join(asked)} Then --columns {changed}"
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
        Where a law drives the arm its torque is taken, and no other way of wiring is tried, only gravity's sign.

    Returns
    -------
    WiringCheck or None
        None where the torque tells nothing.
    """
    n = arm.n_joint
    straight, upright = tuple(range(n)), (1,) * n
    as_given = _Sums.of(arm, base, trials)
    if not as_given.power.sum() > 0.0 or not np.any(as_given.gram):
        return None
    free = as_given.free_residual(straight, upright)
    possible = as_given.possible_residual(straight, upright) if free < 1.0 else 1.0
    ways = [(as_given, *way) for way in _ways(n)] if arm.control.law == "measured" else []
    if any(arm.gravity_m_s2):
        x, y, z = arm.gravity_m_s2
        upside_down = _Sums.of(replace(arm, gravity_m_s2=(-x, -y, -z)), base, trials)
        ways.append((upside_down, straight, upright))
    ranked = sorted(
        (sums.free_residual(column, sign), sum(map(int.__ne__, column, straight)), sign.count(-1), number)
        for number, (sums, column, sign) in enumerate(ways)
    )
    better: Wiring | None = None
    spare = as_given.independent - len(base.independent)
    if spare <= 0.0:  # any columns can be explained
        return WiringCheck(free, possible, None)
    far_less = min(_FAR_LESS, _ODDS ** (-2.0 / spare))
    for residual, _, _, number in ranked[:_SHORTLIST]:
        sums, column, sign = ways[number]
        limit = far_less * possible if better is None else 0.99 * better.residual_share
        if residual < limit and (found := sums.possible_residual(column, sign)) < limit:
            better = Wiring(column, sign, found, falls_up=sums is not as_given)
    return WiringCheck(free, possible, better)


@dataclass(frozen=True)
class _Sums:
    """Normal equations of each joint with the torque in each column.

    Attributes
    ----------
    arm : Arm
    base : BaseParameters
    gram, moment : (n_joint, n_base, n_base), (n_joint, n_column, n_base)
    power, count : (n_column,), (n_joint,)
    independent : float
        Independent numbers: behind a filter a trial has two a period of its corner and joint.
    """

    arm: Arm
    base: BaseParameters
    gram: Floats
    moment: Floats
    power: Floats
    count: Floats
    independent: float

    @classmethod
    def of(cls, arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> "_Sums":
        """Return the sums of thinned trials, where joints move."""
        n, n_base = arm.n_joint, len(base.independent)
        gram, moment = np.zeros((n, n_base, n_base)), np.zeros((n, n, n_base))
        power, count = np.zeros((2, n))
        independent = 0.0
        for trial in trials:
            if has_unknown_target(arm, trial):
                continue
            some = slice(None, None, max(1, len(trial.q) // _SAMPLES))
            tau = torque_target(arm, trial)[some]
            q, dq, ddq = trial.q[some], trial.dq[some], trial.ddq[some]
            rows = regressor(arm, q, dq, ddq)[..., base.independent]
            moving = (is_moving(dq) & trial.counted[some]).all(axis=1)
            rows, tau = rows[moving], tau[moving]
            gram += np.einsum("sja,sjb->jab", rows, rows)
            moment += np.einsum("sja,sk->jka", rows, tau)
            power += np.sum(tau**2, axis=0)
            count += len(tau)
            independent += n * trial.n_independent * float(moving.mean())
        return cls(arm, base, gram, moment, power, count, independent)

    def free_residual(self, column: Sequence[int], sign: Sequence[int]) -> float:
        """Return what share of the torque's power the best numbers leave under a way of wiring."""
        try:
            return float(self._problem(column, sign).rest / self.power.sum())
        except NotIdentifiable:
            return 1.0

    def possible_residual(self, column: Sequence[int], sign: Sequence[int]) -> float:
        """Return what share of the torque's power the best arm that can exist leaves under a way of wiring."""
        problem = self._problem(column, sign)
        try:
            genes, _ = physical_optimum(self.arm, self.base, problem)
        except NotConverged:
            return 1.0
        return float(problem.cost(genes[None])[0] / self.power.sum())

    def _problem(self, column: Sequence[int], sign: Sequence[int]) -> TorqueProblem:
        own = np.array([sign[i] * self.moment[i, column[i]] for i in range(self.arm.n_joint)])
        sums = TorqueSums(
            gram=self.gram[None],
            moment=own[None],
            power=self.power[list(column)][None],
            row=np.zeros((1, *own.shape)),
            torque=np.zeros((1, self.arm.n_joint)),
            count=self.count[None],
            trial=np.zeros(1, dtype=np.intp),
            samples=int(self.count.max()),
        )
        return torque_problem(sums, self.base.combination @ standard_parameters(self.arm))


def _ways(n: int) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Iterate over the ways of wiring that are tried besides the columns as given."""
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
