"""Determinants of many small mass matrices, and their derivatives, compiled: a search asks for them often."""

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import ROUNDED
from limbcal.compiled import compiled

#: Least pivot of a positive matrix, relative to its largest element: half the digits of a double.
_LEAST_PIVOT = float(np.sqrt(ROUNDED))


@compiled
def log_determinant(masses: Floats, weight: Floats) -> float:
    """Return ``sum w log det M`` of masses M; minus infinity if one of them is no mass.

    A mass has a positive definite symmetric part.

    Parameters
    ----------
    masses : (n, n_joint, n_joint)
    weight : (n,)
    """
    n, n_joint = masses.shape[:2]
    M, S = np.empty((n_joint, n_joint)), np.empty((n_joint, n_joint))
    total = 0.0
    for t in range(n):
        largest = 0.0
        for i in range(n_joint):
            for j in range(n_joint):
                M[i, j] = masses[t, i, j]
                S[i, j] = 0.5 * (masses[t, i, j] + masses[t, j, i])
                largest = max(largest, abs(M[i, j]))
        if not _eliminated(S) > _LEAST_PIVOT * largest:
            return -np.inf
        _eliminated(M)
        determinant = 1.0
        for i in range(n_joint):
            determinant *= M[i, i]
        total += weight[t] * np.log(determinant)
    return total


@compiled
def solved_slopes(masses: Floats, slopes: Floats) -> Floats:
    """Return ``M^-1 M_k`` for masses M with slopes ``M_k``, shaped like these.

    The symmetric part of every M is positive definite.

    Parameters
    ----------
    masses : (n, n_joint, n_joint)
    slopes : (n, n_joint, n_joint, n_factor)
    """
    n, n_joint, _, n_factor = slopes.shape
    M, B = np.empty((n_joint, n_joint)), slopes.copy()
    for t in range(n):
        M[:] = masses[t]
        _eliminated(M)
        for i in range(n_joint):
            for j in range(i):
                for k in range(n_joint):
                    for m in range(n_factor):
                        B[t, i, k, m] -= M[i, j] * B[t, j, k, m]
        for i in range(n_joint - 1, -1, -1):
            for k in range(n_joint):
                for m in range(n_factor):
                    rest = B[t, i, k, m]
                    for j in range(i + 1, n_joint):
                        rest -= M[i, j] * B[t, j, k, m]
                    B[t, i, k, m] = rest / M[i, i]
    return B


@compiled
def determinant_slopes(masses: Floats, weight: Floats, slopes: Floats) -> Floats:
    """Return the slopes of `log_determinant`, ``sum w tr M^-1 M_k``, (n_factor,), of what `solved_slopes` has."""
    n, n_joint, _, n_factor = slopes.shape
    M, inverse, found = np.empty((n_joint, n_joint)), np.empty((n_joint, n_joint)), np.zeros(n_factor)
    for t in range(n):
        M[:] = masses[t]
        _eliminated(M)
        for k in range(n_joint):
            for i in range(n_joint):
                rest = 1.0 if i == k else 0.0
                for j in range(i):
                    rest -= M[i, j] * inverse[j, k]
                inverse[i, k] = rest
            for i in range(n_joint - 1, -1, -1):
                rest = inverse[i, k]
                for j in range(i + 1, n_joint):
                    rest -= M[i, j] * inverse[j, k]
                inverse[i, k] = rest / M[i, i]
        for i in range(n_joint):
            for j in range(n_joint):
                share = weight[t] * inverse[j, i]
                for m in range(n_factor):
                    found[m] += share * slopes[t, i, j, m]
    return found


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
