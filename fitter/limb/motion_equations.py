"""Normal equations of a limb's angles over successive frames: kernels.

A motion's prior is of its third differences, so frames have information on each other up to three apart: a band.
It is kept as LAPACK has a lower band, transposed: row ``j`` holds elements ``(j, j), (j + 1, j) …`` of the matrix.
Of some frames in a row, while those outside are held, matrix and slope are their part of the whole ones.
"""

import math

import numpy as np

from arm.marker_kinematics import MarkerChain, Slopes
from arm.model import Floats
from fitter.limb.frame_equations import frame_equations
from fitter.limb.marker_observations import FREEDOM, AnglePrior, Frames
from limbcal.compiled import compiled

#: Frames before one that its prior has to do with.
BEFORE = 3
_THIRD_DIFFERENCE = (-1.0, 3.0, -3.0, 1.0)


@compiled
def marker_equations(
    chain: MarkerChain,
    frames: Frames,
    variance: Floats,
    prior: AnglePrior,
    q: Floats,
    room: Slopes,
    first: int,
    end: int,
    A: Floats,
    a: Floats,
) -> float:
    """Fill in the markers' equations of each of the frames from ``first`` to before ``end``; return their cost."""
    total = 0.0
    for k in range(first, end):
        total += frame_equations(chain, frames, k, variance, prior, q[k], room, A[k], a[k])
    return total


@compiled
def roughness(q: Floats, jerk: Floats, first: int, end: int, pull: Floats) -> float:
    """Return minus twice the log prior of a motion, as far as some frames have to do with it, up to a constant.

    ``pull`` (n_frame, n) becomes the slope of half of it at the frames from ``first`` to before ``end``. Fewer
    than four frames have no third difference.
    """
    total = 0.0
    pull[first:end] = 0.0
    for r in range(max(first - BEFORE, 0), min(end, q.shape[0] - BEFORE)):
        for i in range(q.shape[1]):
            x = q[r + 3, i] - q[r, i] + 3.0 * (q[r + 1, i] - q[r + 2, i])
            squares = jerk[i] * x * x / FREEDOM
            total += math.log1p(squares)
            x *= (FREEDOM + 1.0) / FREEDOM * jerk[i] / (1.0 + squares)
            for c in range(BEFORE + 1):
                if first <= r + c < end:
                    pull[r + c, i] += _THIRD_DIFFERENCE[c] * x
    return (FREEDOM + 1.0) * total


@compiled
def fill_band(q: Floats, jerk: Floats, A: Floats, share: float, first: int, end: int, band: Floats) -> None:
    """Fill in the information on frames from ``first`` to before ``end``, ((end - first) n, 3 n + 1).

    Parameters
    ----------
    q : (n_frame, n)
    jerk : (n,)
        Information on third differences, where they are small.
    A : (n_frame, n, n)
        That of the markers.
    share : float
        By which the markers' information counts.
    first, end : int
    band : ((end - first) n, 3 n + 1)
    """
    n = q.shape[1]
    band[:] = 0.0
    for k in range(first, end):
        for i in range(n):
            for below in range(n - i):
                band[(k - first) * n + i, below] = share * A[k, i + below, i]
    for r in range(max(first - BEFORE, 0), min(end, q.shape[0] - BEFORE)):
        for i in range(n):
            x = q[r + 3, i] - q[r, i] + 3.0 * (q[r + 1, i] - q[r + 2, i])
            weight = (FREEDOM + 1.0) / (FREEDOM + jerk[i] * x * x) * jerk[i]
            for c in range(BEFORE + 1):
                if first <= r + c < end:
                    for d in range(c, BEFORE + 1):
                        at = (r + c - first) * n + i
                        band[at, (d - c) * n] += _THIRD_DIFFERENCE[c] * _THIRD_DIFFERENCE[d] * weight


@compiled
def inverse_diagonal(L: Floats, diagonal: Floats) -> None:
    """Fill in the diagonal of a matrix' inverse, given its Cholesky factor as a transposed lower band.

    Only what the band holds of the inverse is needed on the way (Takahashi, Fagan and Chin 1973).
    """
    n, width = L.shape[0], L.shape[1] - 1
    Z = np.zeros((n, width + 1))  # Z[j, k]: element (j + k, j) of the inverse
    for j in range(n - 1, -1, -1):
        most = min(width, n - 1 - j)
        d = L[j, 0]
        for k in range(most, -1, -1):
            total = 1.0 / d if k == 0 else 0.0
            for m in range(1, most + 1):
                low, high = (m, k) if m < k else (k, m)
                total -= L[j, m] * Z[j + low, high - low]
            Z[j, k] = total / d
        diagonal[j] = Z[j, 0]
