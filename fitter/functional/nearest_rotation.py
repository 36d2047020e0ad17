"""The rotations nearest to 3 × 3 matrices, compiled: a recording has thousands of them.

A rotation's quaternion q makes ``tr R^T D`` the quadratic form ``q^T N q`` of a symmetric 4 × 4 matrix that is
linear in D, so the nearest rotation is N's eigenvector with the largest eigenvalue, and never a mirror (B. K. P.
Horn, *Closed-form solution of absolute orientation using unit quaternions*, 1987). Jacobi's rotations find it
(Golub and Van Loan 2013, 8.5).
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled

#: Sweeps over the elements off the diagonal at the most; convergence is quadratic, and about five are enough.
_SWEEPS = 20
#: Squares of elements off the diagonal, relative to all, that are rounding.
_ROUNDED = float(np.finfo(np.float64).eps ** 2)


@compiled
def nearest_rotations(D: Floats) -> Floats:
    """Return the rotations R that maximise ``tr R^T D`` for some matrices D, (n, 3, 3).

    Parameters
    ----------
    D : (n, 3, 3)
        Of a rank below two, several rotations are as near; one of them is returned.
    """
    R, N, V = np.empty(D.shape), np.empty((4, 4)), np.empty((4, 4))
    for t in range(D.shape[0]):
        (a, b, c), (d, e, f), (g, h, i) = D[t, 0], D[t, 1], D[t, 2]
        N[0, 0], N[0, 1], N[0, 2], N[0, 3] = a + e + i, h - f, c - g, d - b
        N[1, 0], N[1, 1], N[1, 2], N[1, 3] = h - f, a - e - i, b + d, c + g
        N[2, 0], N[2, 1], N[2, 2], N[2, 3] = c - g, b + d, e - a - i, f + h
        N[3, 0], N[3, 1], N[3, 2], N[3, 3] = d - b, c + g, f + h, i - a - e
        _diagonalise(N, V)
        most = 0
        for k in range(1, 4):
            if N[k, k] > N[most, most]:
                most = k
        w, x, y, z = V[0, most], V[1, most], V[2, most], V[3, most]
        R[t, 0, 0], R[t, 1, 1], R[t, 2, 2] = w * w + x * x, w * w + y * y, w * w + z * z
        R[t, 0, 1], R[t, 0, 2], R[t, 1, 2] = x * y - w * z, x * z + w * y, y * z - w * x
        R[t, 1, 0], R[t, 2, 0], R[t, 2, 1] = x * y + w * z, x * z - w * y, y * z + w * x
        for k in range(3):
            R[t, k, k] -= 0.5
            for j in range(3):
                R[t, k, j] *= 2.0
    return R


@compiled
def _diagonalise(A: Floats, V: Floats) -> None:
    """Make a symmetric matrix diagonal in place, and fill in its eigenvectors as columns."""
    n = A.shape[0]
    V[:] = 0.0
    for k in range(n):
        V[k, k] = 1.0
    for _ in range(_SWEEPS):
        off, every = 0.0, 0.0
        for i in range(n):
            for j in range(n):
                every += A[i, j] * A[i, j]
                off += A[i, j] * A[i, j] if i != j else 0.0
        if not off > _ROUNDED * every:
            return
        for p in range(n - 1):
            for q in range(p + 1, n):
                if A[p, q] == 0.0:
                    continue
                slope = (A[q, q] - A[p, p]) / (2.0 * A[p, q])
                t = (1.0 if slope >= 0.0 else -1.0) / (abs(slope) + np.sqrt(1.0 + slope * slope))
                c = 1.0 / np.sqrt(1.0 + t * t)
                s = t * c
                for k in range(n):
                    A[k, p], A[k, q] = c * A[k, p] - s * A[k, q], s * A[k, p] + c * A[k, q]
                for k in range(n):
                    A[p, k], A[q, k] = c * A[p, k] - s * A[q, k], s * A[p, k] + c * A[q, k]
                for k in range(n):
                    V[k, p], V[k, q] = c * V[k, p] - s * V[k, q], s * V[k, p] + c * V[k, q]
