r"""The density of a motion given the torque: what keeps a model from explaining everything by having no mass.

Where something moves the arm that the model lacks, the motion is likely not only by what the torque equation
leaves but by how that turns with the acceleration, the masses ``M``:

.. math:: \log p = -\tfrac12 \sum_f |r_f|^2 + w \sum_f \log |\det M|

with w = 1 where the torque is known (by a law, or none), and 1/2 where it was measured: how much of what is
lacking moved the arm (1) is unknown, and how much is an error of the measured torque, which moved nothing (0).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.least_squares import ITERATIONS, ODDS_NATS, ROUNDED, SETTLED, Normal
from fitter.diagnosis.mass_determinants import determinant_slopes, log_determinant, solved_slopes
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion

#: Numbers, one of every joint at an instant, from which a step's curvature is computed: known to 6 % of their
#: scatter. Only how quickly steps converge depends on it, not where to (sub-sampled Newton: Byrd et al. 2011).
CURVATURE_NUMBERS = 300


@dataclass(frozen=True)
class _Masses:
    """Masses of some motions, which are linear in the factors.

    Attributes
    ----------
    slopes : (n, n_joint, n_joint, n_kept)
        With the factors that they depend on.
    known : (n, n_joint, n_joint)
    weight : (n,)
        Of an instant.
    kept : (n_kept,) int
        The places of these factors among all.
    """

    slopes: Floats
    known: Floats
    weight: Floats
    kept: NDArray[np.intp]

    def at(self, x: Floats) -> Floats:
        """Return the masses under factors x, (n, n_joint, n_joint)."""
        flat = self.slopes.reshape(-1, self.slopes.shape[-1])
        return self.known + (flat @ x[self.kept]).reshape(self.known.shape)

    def score(self, x: Floats) -> Floats:
        """Return the weighted traces of M^-1 M_k by all factors, (n_factor,); 0 for those not kept."""
        score = np.zeros(len(x))
        score[self.kept] = determinant_slopes(self.at(x), self.weight, self.slopes)
        return score

    def information(self, x: Floats) -> Floats:
        """Return the weighted traces of M^-1 M_k M^-1 M_l by all factors, (n_factor, n_factor)."""
        B = solved_slopes(self.at(x), self.slopes)
        weighted = (self.weight[:, None, None, None] * B).reshape(-1, len(self.kept))
        information = np.zeros((len(x), len(x)))
        both = weighted.T @ B.transpose(0, 2, 1, 3).reshape(-1, len(self.kept))
        information[np.ix_(self.kept, self.kept)] = both
        return information

    @cached_property
    def sparse(self) -> "_Masses":
        """Some of the instants, which weigh as much as all."""
        own = slice(None, None, max(1, self.known[..., 0].size // CURVATURE_NUMBERS))
        weight = self.weight[own] * (len(self.weight) / len(self.weight[own]))
        return _Masses(np.ascontiguousarray(self.slopes[own]), self.known[own], weight, self.kept)


class MassDensity:
    """The density of some motions given their torques.

    Parameters
    ----------
    equations : Equations
    motions : sequence of Motion
    weight : float
        w, see the module.
    count : mapping of int to (n_joint,)
        Independent numbers of each motion's equations.
    start : (n_base,)
        Base parameters with masses that a body can have.
    n_number : int
        Numbers over which masses are averaged, one of every joint at an instant: with two joints known to 3 % of
        their scatter, with six to 5 %.
    remembered_bytes : float
        Of what was computed for models so much is kept: the last ones that were asked about.
    """

    def __init__(
        self,
        equations: Equations,
        motions: Sequence[Motion],
        weight: float,
        count: Mapping[int, Floats],
        start: Floats,
        n_number: int = 3000,
        remembered_bytes: float = 1e8,
    ) -> None:
        self._equations, self._weight, self._count, self._start = equations, weight, count, start
        self._motions = motions
        self._remembered_bytes = remembered_bytes
        pushes = np.eye(equations.arm.n_joint)
        self._pushed = {one.number: [replace(one, ddq=one.ddq + push) for push in pushes] for one in motions}
        n_instant = n_number // max(2, equations.arm.n_joint)
        self._stride = max(1, sum(len(one.t) for one in motions) // n_instant)
        self._base: dict[tuple[int, ...], float] = {}
        self._known: dict[tuple[object, ...], tuple[Floats, ...]] = {}

    def of(self, model: Model, x: Floats, motions: Sequence[Motion]) -> float:
        """Return ``w sum log |det M|`` over some motions [nats]; minus infinity for what is no mass."""
        return self.along(model, motions)(x)

    def is_possible(self, base: Floats) -> bool:
        """Say whether base parameters have masses that a body can have, in all motions."""
        return bool(np.isfinite(self.of(Model(), base, self._motions)))

    def along(self, model: Model, motions: Sequence[Motion]) -> Callable[[Floats], float]:
        """Return `of` as a function of the factors: many are asked about under one model."""
        masses = self._masses(model, motions)
        return lambda x: float(log_determinant(masses.at(x), masses.weight))

    def unit(self, model: Model, x: Floats, motions: Sequence[Motion], numbers: float) -> float:
        """Return ``exp(-w sum log |det M| / n)``, 1 for the base model; what has no mass is a large one.

        Parameters
        ----------
        model : Model
        x : (n_factor,)
        motions : sequence of Motion
        numbers : float
            n, the independent numbers of their equations.
        """
        key = tuple(motion.number for motion in motions)
        if key not in self._base:
            self._base[key] = self.of(Model(), self._start, motions)
        more = self.of(model, x, motions) - self._base[key]
        return float(np.exp(min(-more / numbers, ODDS_NATS)))

    def solve(self, normal: Normal, numbers: float, x: Floats, model: Model, motions: Sequence[Motion]) -> Floats:
        """Return the likeliest factors by Newton's steps, the residual's variance being the likeliest, too.

        Parameters
        ----------
        normal : Normal
            Normal equations of these motions.
        numbers : float
            Independent numbers of their equations.
        x : (n_factor,)
            Their answer.
        model : Model
        motions : sequence of Motion
        """
        masses, density = self._masses(model, motions), self.along(model, motions)

        def value(at: Floats) -> float:
            return density(at) - 0.5 * numbers * float(np.log(normal.sum_of_squares(at)))

        here = value(x)
        if not np.isfinite(here):
            x = np.concatenate([self._start, np.zeros(len(x))])[: len(x)]
            here = value(x)
        for _ in range(ITERATIONS):
            if not np.isfinite(here):
                break
            weight = numbers / normal.sum_of_squares(x)
            right = weight * (normal.rhs - normal.gram @ x) + masses.score(x)
            step = _solved(weight * normal.gram + masses.sparse.information(x), right)
            part, there = 1.0, value(x + step)
            while part > SETTLED and not there > here:
                part *= 0.5
                there = value(x + part * step)
            if part <= SETTLED:
                break
            x, gained, here = x + part * step, there - here, there
            if gained < SETTLED:
                break
        return x

    def slopes(self, model: Model, x: Floats, motions: Sequence[Motion]) -> tuple[Floats, Floats]:
        """Return the density's slopes by factors and psi, and its negative second derivatives.

        These are ``w tr(M^-1 M_k)`` and ``w tr(M^-1 M_k M^-1 M_l)``, for masses that are linear in the numbers.

        Returns
        -------
        (n_factor + n_psi,), (n_factor + n_psi, n_factor + n_psi)
        """
        masses = self._masses(model, motions)
        by_psi = [
            (self._masses(more, motions).at(x) - self._masses(less, motions).at(x))[..., None] / step
            for more, less, step in model.central_differences()
        ]
        slopes = np.concatenate([masses.slopes, *by_psi], axis=-1)
        kept = np.concatenate([masses.kept, len(x) + np.arange(len(by_psi))]).astype(np.intp)
        every = _Masses(slopes, masses.known, masses.weight, kept)
        x = np.append(x, np.zeros(len(by_psi)))
        return every.score(x), every.information(x)

    def _masses(self, model: Model, motions: Sequence[Motion]) -> _Masses:
        inertial = [hypothesis.is_inertial for hypothesis in model.hypotheses]
        parts = model.only(inertial)
        # By the hypotheses themselves, not by their keys: an effect may have several forms.
        key = (
            *(motion.number for motion in motions),
            *((one, psi.tobytes()) for one, psi in zip(parts.hypotheses, parts.psi, strict=True)),
        )
        found = self._known.pop(key, None)
        if found is None:
            made = [self._made(parts, motion) for motion in motions]
            found = tuple(np.concatenate(one) for one in zip(*made, strict=True))
            others = max(0, int(self._remembered_bytes / found[0].nbytes) - 1)
            for oldest in list(self._known)[: max(0, len(self._known) - others)]:
                del self._known[oldest]
        self._known[key] = found
        slopes, known, weight = found
        columns = [np.full(one.n_column, turns) for one, turns in zip(model.hypotheses, inertial, strict=True)]
        base = np.ones(slopes.shape[-1] - parts.n_column, dtype=np.bool_)
        return _Masses(slopes, known, weight, np.flatnonzero(np.concatenate([base, *columns])))

    def _made(self, model: Model, motion: Motion) -> tuple[Floats, Floats, Floats]:
        """Return slopes, known part and weights: what accelerations of one make of the equations.

        A stuck joint has a mass of one.
        """
        sparse = slice(None, None, self._stride)

        def sides(one: Motion) -> tuple[Floats, Floats]:
            hypothetical = self._equations.hypothetical(model, one)
            kept = self._equations.independent(hypothetical.arm)
            return hypothetical.equations(kept, sparse), hypothetical.target(self._equations.known, sparse)

        design, target = sides(motion)
        pushed = [sides(one) for one in self._pushed[motion.number]]
        slopes = np.stack([one - design for one, _ in pushed], axis=2)
        known = np.stack([target - one for _, one in pushed], axis=-1)
        moves = ~motion.stuck[sparse]
        both = moves[:, :, None] & moves[:, None, :]
        known = np.where(both, known, np.eye(known.shape[1]))
        count = self._weight * float(np.mean(self._count[motion.number]))
        return slopes * both[..., None], known, np.full(len(slopes), count / len(slopes))


def _solved(matrix: Floats, right: Floats) -> Floats:
    size = np.sqrt(np.diag(matrix))
    size[size == 0.0] = 1.0
    scaled = matrix / np.outer(size, size)
    return np.asarray(np.linalg.lstsq(scaled, right / size, rcond=ROUNDED)[0] / size, dtype=np.float64)
