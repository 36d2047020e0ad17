"""Sums of products turned back into a small least-squares problem.

A cost ``|A x - b|^2`` taken from sums as ``x.AtA x - 2 x.Atb + b.b`` subtracts large numbers that are nearly
equal. A triangle W with ``W^T W = A^T A`` gives the same cost as ``|W x - z|^2 + rest``, in which nothing is
subtracted near the optimum.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled

#: A column whose new part, squared, is smaller than this fraction of itself is collinear with others.
#: In sums of doubles a smaller part is rounding.
_NEW_PART = 1e-11


@dataclass(frozen=True)
class Whitened:
    """``|A x - b|^2 = |W x - z|^2 + rest``, column by column of b.

    Attributes
    ----------
    W : (rank, n_column)
    z : (rank, n_right)
    rest : (n_right,)
        What no x explains, never negative.
    kept, folded : integer arrays
        Columns that say something new, and columns that depend on those.
    scale : (n_column,)
        Norms of the columns of A.
    """

    W: Floats
    z: Floats
    rest: Floats
    kept: NDArray[np.intp]
    folded: NDArray[np.intp]
    scale: Floats

    def dependence(self) -> Floats:
        """Return how the folded columns depend on the kept ones, in scaled units, (n_kept, n_folded)."""
        triangle, others = self._scaled(self.kept), self._scaled(self.folded)
        return backward(triangle, others)

    def solve(self, prior: Floats) -> Floats:
        """Return the x of least cost whose folded entries are the prior's, (n_column, n_right)."""
        x = np.array(prior, dtype=float)
        z = self.z - self.W[:, self.folded] @ x[self.folded]
        x[self.kept] = backward(self._scaled(self.kept), z) / self.scale[self.kept, None]
        return x

    def inverse(self) -> Floats:
        """Return ``(A^T A)^-1`` of the kept columns, in their order, (n_kept, n_kept)."""
        half = backward(self._scaled(self.kept), np.eye(len(self.kept)))
        half /= self.scale[self.kept, None]
        return np.asarray(half @ half.T, dtype=np.float64)

    def condition_number(self) -> float:
        """Return the condition number of the kept columns, each scaled to length one."""
        return float(np.linalg.cond(self._scaled(self.kept))) if len(self.kept) else float("nan")

    def _scaled(self, columns: NDArray[np.intp]) -> Floats:
        return np.ascontiguousarray(self.W[:, columns] / self.scale[columns])


def whiten(gram: Floats, moment: Floats, power: Floats) -> Whitened:
    """Factor sums of products by a Cholesky factorisation with pivots of the column-scaled matrix.

    Parameters
    ----------
    gram : (n_column, n_column)
        A^T A.
    moment : (n_column, n_right)
        A^T b.
    power : (n_right,)
        b.b of every right-hand side.

    Returns
    -------
    Whitened
    """
    scale = np.sqrt(np.maximum(np.diag(gram), 0.0))
    seen = np.flatnonzero(scale > 0.0)
    kept, folded = seen[:0], np.flatnonzero(scale <= 0.0)
    triangle, rank = np.zeros((0, len(seen))), 0
    if len(seen):
        unit = gram[np.ix_(seen, seen)] / np.outer(scale[seen], scale[seen])
        factor, pivots, rank, _ = scipy.linalg.lapack.dpstrf(unit, lower=0, tol=_NEW_PART)
        order = seen[np.asarray(pivots) - 1]
        kept, folded = order[:rank], np.sort(np.concatenate([order[rank:], folded]))
        triangle = np.triu(factor)[:rank]
        seen = order
    W = np.zeros((rank, len(scale)))
    W[:, seen] = triangle * scale[seen]
    z = forward(np.ascontiguousarray(triangle[:, :rank]), moment[kept] / scale[kept, None])
    safe = np.where(scale > 0.0, scale, 1.0)
    return Whitened(W, z, np.maximum(power - np.sum(z * z, axis=0), 0.0), kept, folded, safe)


# Small triangles are solved here: a BLAS wakes its threads for them, which on a busy machine takes milliseconds.
@compiled
def forward(triangle: Floats, right: Floats) -> Floats:
    """Return ``triangle^-T right`` for an upper triangle."""
    x = right.copy()
    for i in range(triangle.shape[0]):
        for j in range(i):
            for k in range(x.shape[1]):
                x[i, k] -= triangle[j, i] * x[j, k]
        for k in range(x.shape[1]):
            x[i, k] /= triangle[i, i]
    return x


@compiled
def backward(triangle: Floats, right: Floats) -> Floats:
    """Return ``triangle^-1 right`` for an upper triangle."""
    x = right.copy()
    for i in range(triangle.shape[0] - 1, -1, -1):
        for j in range(i + 1, triangle.shape[0]):
            for k in range(x.shape[1]):
                x[i, k] -= triangle[i, j] * x[j, k]
        for k in range(x.shape[1]):
            x[i, k] /= triangle[i, i]
    return x
