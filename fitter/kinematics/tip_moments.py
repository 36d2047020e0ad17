"""Moments of angles and tip in which nothing but the geometry and the noise is unknown.

With f(q) = C phi(q), tip noise of covariance R and products psi of `fitter.kinematics.angle_products`,

    E[psi(q~) r]     = E[psi f](q),      E[psi(q~) r r^T] = E[psi f f^T](q) + R E[psi](q)

where the right-hand sides are sums of products of true angles again, and those follow from the measured ones.
So differences of both sides have expectation zero at the true geometry and noise, whatever the angles did and
however few samples there were (Nakamura 1990); they are what a fit sets to zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.kinematics.angle_products import orders, places, products, undone
from fitter.kinematics.tip_basis import Complexes

#: Harmonics of psi; f f^T has two more.
HIGHEST = 2
_LONGEST = HIGHEST + 2
#: The pairs of axes in r r^T.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
#: Numbers held at once for the products of a block of samples, about.
_NUMBERS = 2_000_000


@dataclass(frozen=True)
class MomentSums:
    """Means of products over blocks of consecutive samples.

    Attributes
    ----------
    angles : (n_block, n_place)
        Of products of harmonics to 4.
    tip : (n_block, 9, n_low)
        Of products of harmonics to 2, with x, y, z of the tip and the six products of two of these.
    count : (n_block,)
        Samples.
    trial : (n_block,) int
    """

    angles: Complexes
    tip: Complexes
    count: Floats
    trial: NDArray[np.intp]

    def whole(self) -> "MomentSums":
        """Return the means over all samples."""
        share = self.count / self.count.sum()
        angles, tip = np.tensordot(share, self.angles, axes=1), np.tensordot(share, self.tip, axes=1)
        return MomentSums(angles[None], tip[None], self.count.sum(keepdims=True), self.trial[:1])


def joined(parts: Sequence[MomentSums]) -> MomentSums:
    """Return the blocks of several sums."""
    return MomentSums(
        np.concatenate([part.angles for part in parts]),
        np.concatenate([part.tip for part in parts]),
        np.concatenate([part.count for part in parts]),
        np.concatenate([part.trial for part in parts]),
    )


@dataclass(frozen=True)
class TipMoments:
    """Which moments are looked at: those of psi up to some total order.

    Attributes
    ----------
    revolute : (n_joint,) bool
    order : int
        Sum of the orders of all joints in a psi.
    """

    revolute: tuple[bool, ...]
    order: int

    @cached_property
    def instruments(self) -> NDArray[np.intp]:
        """Orders of every psi, (n_psi, n_joint); of a psi and its conjugate only one."""
        every = np.array(list(product(*(orders(turns, HIGHEST) for turns in self.revolute))), dtype=np.intp)
        harmonics = every[:, list(self.revolute)]
        upper = [tuple(k) >= (0,) * len(k) for k in harmonics]
        return np.asarray(every[(np.abs(every).sum(axis=1) <= self.order) & upper])

    @property
    def size(self) -> int:
        """Number of moments, real and imaginary parts counted."""
        return 18 * len(self.instruments)

    def sums(self, q: Floats, tip: Floats, trial: int = 0, blocks: int = 1) -> MomentSums:
        """Average the products over blocks of the samples of one trial.

        Parameters
        ----------
        q : (n_sample, n_joint)
        tip : (n_sample, 3)
        trial : int
        blocks : int
            Most blocks of consecutive samples.
        """
        ends = np.linspace(0, len(q), min(blocks, len(q)) + 1).astype(np.intp)
        n_place, low = int(np.prod(places(self.revolute, _LONGEST))), self._low
        angles = np.zeros((len(ends) - 1, n_place), dtype=complex)
        with_tip = np.zeros((len(ends) - 1, 9, len(low)), dtype=complex)
        step = max(1, _NUMBERS // n_place)
        for block, (first, last) in enumerate(zip(ends[:-1], ends[1:], strict=True)):
            for start in range(first, last, step):
                part = slice(start, min(start + step, last))
                table = products(self.revolute, q[part], _LONGEST)
                angles[block] += table.sum(axis=0)
                with_tip[block] += _with_squares(tip[part]).T @ table[:, low]
        count = np.diff(ends).astype(float)
        trials = np.full(len(count), trial, dtype=np.intp)
        return MomentSums(angles / count[:, None], with_tip / count[:, None, None], count, trials)

    def samples(self, q: Floats, tip: Floats, C: Floats, variance: Floats, R: Floats) -> Floats:
        """Return the moments of every single sample, (n_sample, n_moment)."""
        step = max(1, _NUMBERS // (4 * int(np.prod(places(self.revolute, _LONGEST)))))
        out = []
        for start in range(0, len(q), step):
            r = _with_squares(tip[start : start + step])
            table = products(self.revolute, q[start : start + step], _LONGEST)
            one_by_one = MomentSums(
                table, r[:, :, None] * table[:, None, self._low], np.ones(len(r)), np.zeros(len(r), dtype=np.intp)
            )
            out.append(self.values(one_by_one, C, variance, R))
        return np.concatenate(out)

    def moved(self, sums: MomentSums, origin: Floats) -> MomentSums:
        """Return the sums of tips that all stand elsewhere.

        Parameters
        ----------
        sums : MomentSums
        origin : (n_trial, 3) [m]
            What is added to the tip in each trial.
        """
        o, alone = origin[sums.trial], sums.angles[:, None, self._low]
        tip = sums.tip.copy()
        for k, (x, y) in enumerate(PAIRS, start=3):
            tip[:, k] += o[:, x, None] * sums.tip[:, y] + o[:, y, None] * sums.tip[:, x]
            tip[:, k] += (o[:, x] * o[:, y])[:, None] * alone[:, 0]
        tip[:, :3] += o[:, :, None] * alone
        return MomentSums(sums.angles, tip, sums.count, sums.trial)

    def values(self, sums: MomentSums, C: Floats, variance: Floats, R: Floats) -> Floats:
        """Return the moments, whose expectations are zero at the true geometry and noise.

        Parameters
        ----------
        sums : MomentSums
        C : (3, n_basis)
            Of `fitter.kinematics.tip_basis.coefficients`, with the constant.
        variance : (n_joint,)
            Of the angles' noise.
        R : (6,)
            Covariance of the tip's noise, in the order of `PAIRS`.

        Returns
        -------
        (n_block, n_moment)
        """
        F = self._exponentials(C)
        clean = undone(self.revolute, sums.angles, _LONGEST, variance)
        measured = undone(self.revolute, sums.tip, HIGHEST, variance)[..., self._flat(self.instruments, HIGHEST)]
        out = np.swapaxes(measured, -1, -2).copy()  # (n_block, n_psi, 9)
        out[..., :3] -= clean[:, self._reached(1)] @ F.reshape(3, -1).T
        out[..., 3:] -= clean[:, self._reached(2)] @ self._squared(F).T
        out[..., 3:] -= clean[:, self._flat(self.instruments, _LONGEST), None] * R
        out = out.reshape(len(clean), -1)
        return np.asarray(np.concatenate([out.real, out.imag], axis=1), dtype=np.float64)

    @property
    def _low(self) -> NDArray[np.intp]:
        """Where products of harmonics to 2 stand among those to 4."""
        return self._flat(np.array(list(product(*(orders(t, HIGHEST) for t in self.revolute)))), _LONGEST)

    def _exponentials(self, C: Floats) -> Complexes:
        """Return C for harmonics -1, 0, 1 (or powers 0, 1) instead of 1, cos, sin, (3, 3 or 2, …)."""
        turn = np.array([[0.0, 1.0, 0.0], [0.5, 0.0, 0.5], [0.5j, 0.0, -0.5j]])
        out = C.reshape(3, *(3 if turns else 2 for turns in self.revolute)).astype(complex)
        for joint, turns in enumerate(self.revolute):
            if turns:
                out = np.moveaxis(np.moveaxis(out, joint + 1, -1) @ turn, -1, joint + 1)
        return out

    def _squared(self, F: Complexes) -> Complexes:
        """Return the coefficients of f f^T, (6, n_place)."""
        shape = F.shape[1:]
        out = np.zeros((6, *(2 * size - 1 for size in shape)), dtype=complex)
        for place in np.ndindex(shape):
            window = tuple(slice(k, k + size) for k, size in zip(place, shape, strict=True))
            here = F.reshape(3, -1)[:, np.ravel_multi_index(place, shape)]
            for pair, (x, y) in enumerate(PAIRS):
                out[pair][window] += here[x] * F[y]
        return out.reshape(6, -1)

    def _flat(self, order: NDArray[np.intp], longest: int) -> NDArray[np.intp]:
        """Return where products of these orders stand, (…,) from (…, n_joint)."""
        shifted = order + np.array([longest if turns else 0 for turns in self.revolute])
        flat = np.ravel_multi_index(tuple(np.moveaxis(shifted, -1, 0)), places(self.revolute, longest))
        return np.asarray(flat, dtype=np.intp)

    def _reached(self, longest: int) -> NDArray[np.intp]:
        """Return where psi times each product of f (or f f^T) stands, (n_psi, n_product)."""
        steps = np.array(list(product(*(orders(turns, longest) for turns in self.revolute))))
        return self._flat(self.instruments[:, None, :] + steps, _LONGEST)


def _with_squares(tip: Floats) -> Floats:
    """Return the tip and the products of its coordinates, (n_sample, 9)."""
    return np.column_stack([tip, *(tip[:, x] * tip[:, y] for x, y in PAIRS)])
