"""Structural ambiguity of an arm under a law: the common factor, and parameters that only show together.

The data is a motion that obeys *some* arm and *some* gains. Which those are does not matter for what can be
determined: the sums of the motion's own columns are taken, and the targets in them put where a law with arbitrary
numbers would have had them. The equation then holds exactly, and the null space of the sums is all that is
ambiguous: the factors, and trades of one parameter for another, such as viscous friction for kv, which multiply
the same column.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.controller.law_columns import LawColumns

#: A direction that adds less than this fraction to the columns, squared, is none: sums of doubles cannot
#: distinguish it from rounding, as in `fitter.search.whitened`.
_NEW_PART = 1e-11
#: A part of a null vector, in units of its column's size, that is smaller than this is rounding: the root of that.
_PART = 1e-5


@dataclass(frozen=True)
class Ambiguity:
    """What stays open when some parameters are known.

    Attributes
    ----------
    factors : (n_factor, n_column)
        Directions in which the gains kp move along, each with a 1 at a kp of its own (`leaders`), and without what
        trades.
    leaders : tuple of int
    trades : (n_trade, n_column)
        Directions in which no kp moves; each with a 1 at a parameter of its own (`folded`), where others have 0.
    folded : tuple of int
        Parameters that must be held for the others to be determined.
    """

    factors: Floats
    leaders: tuple[int, ...]
    trades: Floats
    folded: tuple[int, ...]

    def open(self) -> NDArray[np.bool_]:
        """Say which parameters the data cannot determine by themselves, (n_column,)."""
        return np.asarray(np.any(np.vstack([self.factors, self.trades]) != 0.0, axis=0))

    def combinations(self) -> list[dict[int, float]]:
        """Return what is determined of the parameters that trade: weights of combinations, each led by a 1."""
        found = []
        for k in np.flatnonzero(np.any(self.trades != 0.0, axis=0)):
            if k not in self.folded:
                weights = {int(k): 1.0}
                for row, f in zip(self.trades, self.folded, strict=True):
                    if row[k] != 0.0:
                        weights[f] = -float(row[k])
                found.append(weights)
        return found


class LawNullSpace:
    """The null space of a law's equation for some motion.

    Parameters
    ----------
    columns : LawColumns
    gram : (n_joint, n_column, n_column)
        Sums of products of the columns of the motion's equations.
    zero : sequence of int
        Parameters that are known to be zero: a zero fixes no factor.
    """

    def __init__(self, columns: LawColumns, gram: Floats, zero: Sequence[int] = ()) -> None:
        self._columns = columns
        n, kp = len(columns.names), list(columns.kp)
        gram = gram[:, :n, :n]
        size = np.sqrt(np.einsum("jaa->a", gram))
        values = np.where(size > 0.0, 1.0, 0.0) / np.where(size > 0.0, size, 1.0)
        values *= np.random.default_rng(0).uniform(1.0, 2.0, n)  # arbitrary, and the answer does not depend on it
        values[list(zero)] = 0.0
        exact = np.zeros((n, n))
        for j, place in enumerate(kp):
            onto = np.eye(n)
            if values[place] != 0.0:
                onto[:, place] = -values / values[place]
                onto[kp, place] = 0.0
            exact += onto.T @ gram[j] @ onto
        scale = np.sqrt(np.maximum(np.diag(exact), 0.0))
        self._seen = scale > 0.0
        self._scale = np.where(self._seen, scale, 1.0)
        eigenvalues, vectors = np.linalg.eigh(exact / np.outer(self._scale, self._scale))
        # (n_null, n_column), in units of the columns' sizes
        self._basis = np.asarray(vectors[:, eigenvalues < _NEW_PART * n].T, dtype=np.float64)

    def given(self, known: Sequence[int]) -> Ambiguity:
        """Return what stays open when some parameters are known."""
        basis = _vanishing(self._basis, list(known))
        kp = [place for place in self._columns.kp if self._seen[place]]
        factors, leaders = _reduced(basis, kp)
        trades, folded = _reduced(_vanishing(basis, kp), self._fold_order())
        factors = factors - factors[:, folded] @ trades  # a factor takes no part in what trades
        factors = np.where(np.abs(factors) > _PART, factors, 0.0) / self._scale
        trades = trades / self._scale
        factors *= self._scale[leaders][:, None]
        trades *= self._scale[folded][:, None]
        return Ambiguity(factors, tuple(leaders), trades, tuple(folded))

    def _fold_order(self) -> list[int]:
        """Return who is held first where parameters trade.

        Friction before the controller's damping, which as a rule is the larger by far; gains of accelerations
        before masses and inertias.
        """
        names = self._columns.names
        kinds = ("fc", "D", "ka", "kv", "kp")
        rank = {k: next((i for i, kind in enumerate(kinds) if n.startswith(kind)), 5) for k, n in enumerate(names)}
        return sorted(rank, key=lambda k: (rank[k], -k))


def _vanishing(basis: Floats, places: list[int]) -> Floats:
    """Return a basis of those vectors of a space that are zero in some places."""
    if not len(basis) or not places:
        return basis
    U, sizes, _ = np.linalg.svd(basis[:, places])
    rank = int(np.count_nonzero(sizes > _PART))
    return np.asarray(U[:, rank:].T @ basis, dtype=np.float64)


def _reduced(basis: Floats, order: Sequence[int]) -> tuple[Floats, list[int]]:
    """Return a space's reduced echelon form, pivots taken in some order, as far as that goes, and the pivots."""
    rows, pivots = np.array(basis), list[int]()
    for k in order:
        done = len(pivots)
        if done == len(rows):
            break
        best = done + int(np.argmax(np.abs(rows[done:, k])))
        if abs(rows[best, k]) > _PART:
            rows[[done, best]] = rows[[best, done]]
            rows[done] /= rows[done, k]
            others = np.arange(len(rows)) != done
            rows[others] -= np.outer(rows[others, k], rows[done])
            pivots.append(k)
    rows = rows[: len(pivots)]
    return np.where(np.abs(rows) > _PART, rows, 0.0), pivots
