r"""The density of a motion given the torque: what keeps a model from explaining everything by having no mass.

Where something moves the arm that the model lacks, the motion is likely not only by what the torque equation
leaves but by how that turns with the acceleration, the masses ``M``:

.. math:: \log p = -\tfrac12 \sum_f |r_f|^2 + w \sum_f \log |\det M|

with w = 1 where the torque is known (by a law, or none), and 1/2 where it was measured: of what is lacking, nobody
knows how much moved the arm (1) and how much is an error of the measured torque, which moved nothing (0).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.rows import Equations

#: Masses change slowly: the logarithm is averaged over this number of instants.
_INSTANTS = 1500
#: Newton's steps at the most, the gain [nats] of the last one, and the least part of one.
_ROUNDS, _SETTLED, _LEAST_PART = 20, 1e-3, 1e-4
#: Masses have a direction without any if one eigenvalue is no larger than this part of the largest: rounding.
_SINGULAR = 1e-6
#: Columns that are this near to depending on others, in terms of the normal equations, do so.
_DEPENDENT = 1e-11
#: Models whose masses are remembered.
_REMEMBERED = 300

#: Slopes of the masses with the factors, (n, n_factor, n_joint, n_joint), their known part, rows an instant.
_Masses = tuple[Floats, Floats, float]


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
    """

    def __init__(
        self,
        equations: Equations,
        motions: Sequence[Motion],
        weight: float,
        count: Mapping[int, Floats],
        start: Floats,
    ) -> None:
        self._equations, self._weight, self._count, self._start = equations, weight, count, start
        pushes = np.eye(equations.arm.n_joint)
        self._pushed = {one.number: [replace(one, ddq=one.ddq + push) for push in pushes] for one in motions}
        self._stride = max(1, sum(len(one.t) for one in motions) // _INSTANTS)
        self._known: dict[tuple[object, ...], _Masses] = {}

    def of(self, model: Model, x: Floats, motions: Sequence[Motion]) -> float:
        """Return ``w sum log |det M|`` over some motions [nats]; minus infinity for what is no mass."""
        total = 0.0
        for motion in motions:
            slopes, known, count = self._masses(model, motion)
            M = np.einsum("tkab,k->tab", slopes, x) + known
            values = np.linalg.eigvalsh(0.5 * (M + M.mT))
            if np.any(values[:, 0] <= _SINGULAR * np.abs(values).max(axis=1)):
                return -np.inf
            total += self._weight * count * float(np.linalg.slogdet(M)[1].sum())
        return total

    def solve(self, gram: Floats, pull: Floats, x: Floats, model: Model, motions: Sequence[Motion]) -> Floats:
        """Return the likeliest factors by Newton's steps.

        Parameters
        ----------
        gram, pull : (n_factor, n_factor), (n_factor,)
            Normal equations.
        x : (n_factor,)
            Their answer.
        model : Model
        motions : sequence of Motion
        """

        def value(at: Floats) -> float:
            return -0.5 * float(at @ gram @ at) + float(pull @ at) + self.of(model, at, motions)

        here = value(x)
        if not np.isfinite(here):
            x = np.concatenate([self._start, np.zeros(len(x))])[: len(x)]
            here = value(x)
        for _ in range(_ROUNDS):
            if not np.isfinite(here):
                break
            score, information = self._slopes(model, x, motions)
            step = _solved(gram + information, pull - gram @ x + score)
            part = 1.0
            while part > _LEAST_PART and not value(x + part * step) > here:
                part *= 0.5
            if part <= _LEAST_PART:
                break
            x = x + part * step
            before, here = here, value(x)
            if here - before < _SETTLED:
                break
        return x

    def _slopes(self, model: Model, x: Floats, motions: Sequence[Motion]) -> tuple[Floats, Floats]:
        """Return the density's slope and its negative second derivative: tr(M^-1 M_k), tr(M^-1 M_k M^-1 M_l)."""
        score, information = np.zeros(len(x)), np.zeros((len(x), len(x)))
        for motion in motions:
            slopes, known, count = self._masses(model, motion)
            M = np.einsum("tkab,k->tab", slopes, x) + known
            B = np.linalg.solve(M[:, None], slopes)
            score += self._weight * count * np.einsum("tkaa->k", B)
            information += self._weight * count * np.einsum("tkab,tlba->kl", B, B)
        return score, information

    def _masses(self, model: Model, motion: Motion) -> _Masses:
        parts = zip(model.hypotheses, model.psi, strict=True)
        # By the hypotheses themselves, not by their keys: an effect may have several forms.
        key = (motion.number, *((hypothesis, psi.tobytes()) for hypothesis, psi in parts))
        if key not in self._known:
            if len(self._known) >= _REMEMBERED * len(self._pushed):
                self._known.clear()
            self._known[key] = self._made(model, motion)
        return self._known[key]

    def _made(self, model: Model, motion: Motion) -> _Masses:
        """Return the masses: what accelerations of one make of the equations; a stuck joint has one."""
        sparse = slice(None, None, self._stride)

        def sides(one: Motion) -> tuple[Floats, Floats]:
            view = self._equations.view(model, one)
            kept = self._equations.independent(view.arm)
            return view.equations(kept)[sparse], view.target(self._equations.known)[sparse]

        design, target = sides(motion)
        pushed = [sides(one) for one in self._pushed[motion.number]]
        slopes = np.stack([one - design for one, _ in pushed], axis=-1).transpose(0, 2, 1, 3)
        known = np.stack([target - one for _, one in pushed], axis=-1)
        moves = ~motion.stuck[sparse]
        both = moves[:, :, None] & moves[:, None, :]
        known = np.where(both, known, np.eye(known.shape[1]))
        return slopes * both[:, None], known, float(np.mean(self._count[motion.number])) / len(slopes)


def _solved(matrix: Floats, right: Floats) -> Floats:
    size = np.sqrt(np.diag(matrix))
    size[size == 0.0] = 1.0
    scaled = matrix / np.outer(size, size)
    return np.asarray(np.linalg.lstsq(scaled, right / size, rcond=_DEPENDENT)[0] / size, dtype=np.float64)
