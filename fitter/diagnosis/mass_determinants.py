"""Determinants of many small mass matrices, and their derivatives, compiled: a search asks for them often."""

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import ROUNDED
from limbcal.compiled import compiled

#: Least pivot of a positive matrix, relative to its largest element: half the digits of a double.
_LEAST_PIVOT = float(np.sqrt(ROUNDED))


@compiled
def log_determinant(known: Floats, slopes: Floats, weight: Floats, x: Floats) -> float:
    """Return ``sum w log det M`` of masses ``M = known + slopes x``; minus infinity if one of them is no mass.

    A mass has a positive definite symmetric part.

    Parameters
    ----------
    known : (n, n_joint, n_joint)
    slopes : (n, n_joint, n_joint, n_factor)
    weight : (n,)
    x : (n_factor,)
    """
    n, n_joint = slopes.shape[:2]
    M, S = np.empty((n_joint, n_joint)), np.empty((n_joint, n_joint))
    total = 0.0
    for t in range(n):
        _mass(known[t], slopes[t], x, M)
        S[:] = 0.5 * (M + M.T)
        largest = np.abs(M).max()
        if not _eliminated(S) > _LEAST_PIVOT * largest:
            return -np.inf
        _eliminated(M)
        for i in range(n_joint):
            total += weight[t] * np.log(M[i, i])
    return total


@compiled
def solved_slopes(known: Floats, slopes: Floats, x: Floats) -> Floats:
    """Return ``M^-1 M_k`` for masses ``M = known + slopes x`` with slopes ``M_k``, shaped like these.

    The symmetric part of every M is positive definite.

    Parameters
    ----------
    known : (n, n_joint, n_joint)
    slopes : (n, n_joint, n_joint, n_factor)
    x : (n_factor,)
    """
    n, n_joint = slopes.shape[:2]
    M, B = np.empty((n_joint, n_joint)), slopes.copy()
    for t in range(n):
        _mass(known[t], slopes[t], x, M)
        _eliminated(M)
        for i in range(n_joint):
            for j in range(i):
                B[t, i] -= M[i, j] * B[t, j]
        for i in range(n_joint - 1, -1, -1):
            for j in range(i + 1, n_joint):
                B[t, i] -= M[i, j] * B[t, j]
            B[t, i] /= M[i, i]
    return B


@compiled
def _mass(known: Floats, slopes: Floats, x: Floats, M: Floats) -> None:
    """Put ``known + slopes x`` into M, (n_joint, n_joint)."""
    n_joint, _, n_factor = slopes.shape
    for i in range(n_joint):
        for j in range(n_joint):
            M[i, j] = known[i, j]
            for k in range(n_factor):
                M[i, j] += slopes[i, j, k] * x[k]


@compiled
def _eliminated(A: Floats) -> float:
    """Eliminate a matrix in place, A = L U without pivots, and return the least one.

    Elements of one whose symmetric part is positive definite do not grow much (Golub and Van Loan 2013, 4.3).
    """
    n, least = len(A), np.inf
    for k in range(n):
        least = min(least, A[k, k])
        for i in range(k + 1, n):
            A[i, k] /= A[k, k]
            for j in range(k + 1, n):
                A[i, j] -= A[i, k] * A[k, j]
    return least
