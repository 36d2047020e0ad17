"""Normal equations of the bundle fit, with every frame's angles eliminated: kernels.

With slopes ``J`` by a frame's angles and ``G`` by what all frames share (geometry and marker places), the frame's
angles take up ``A = J^T W J + prior``. What is left for the shared numbers is the Schur complement

    S = sum G^T W G - (G^T W J) A^-1 (J^T W G)

and it is summed part by part, so that leaving a part out costs no second fit (`fitter.limb.uncertainty`).
"""

import math

import numpy as np

from arm.marker_kinematics import (
    Integers,
    MarkerChain,
    Slopes,
    free_slopes,
    joint_slopes,
    link_frames,
    marker_at,
)
from arm.model import Floats
from fitter.limb.marker_observations import FREEDOM, AnglePrior, Frames
from limbcal.compiled import compiled


@compiled
def t_weight(squares: float, variance: float) -> float:
    """Return the weight of a marker's three equations, a t distribution's, from its squared distance."""
    return (FREEDOM + 3.0) / (FREEDOM + squares / variance) / variance


@compiled
def t_cost(squares: float, variance: float) -> float:
    """Return minus twice the log likelihood of a marker's distance, up to a constant."""
    return (FREEDOM + 3.0) * math.log1p(squares / (FREEDOM * variance))


@compiled
def bundle_cost(
    chain: MarkerChain, frames: Frames, q: Floats, variance: Floats, prior: AnglePrior, share: Floats, room: Slopes
) -> float:
    """Return minus twice the log likelihood of all frames, each counted by its share, with the angles' prior."""
    total, y = 0.0, np.empty(3)
    for k in range(q.shape[0]):
        link_frames(chain, frames.R[k], frames.p[k], q[k], room)
        own = 0.0
        for m in range(chain.link.size):
            if np.isnan(frames.y[k, m, 0]):
                continue
            marker_at(chain, room, m, y)
            squares = 0.0
            for row in range(3):
                squares += (frames.y[k, m, row] - y[row]) ** 2
            own += t_cost(squares, variance[m])
        for i in range(q.shape[1]):
            own += prior.information[i] * (q[k, i] - prior.mean[i]) ** 2
        total += share[k] * own
    return total


@compiled
def eliminate(  # noqa: PLR0912 - one loop over frames and markers, without arrays made on the way
    chain: MarkerChain,
    frames: Frames,
    q: Floats,
    variance: Floats,
    prior: AnglePrior,
    share: Floats,
    free: Integers,
    damping: float,
    part: Integers,
    room: Slopes,
    gain: Floats,
    shift: Floats,
    S: Floats,
    b: Floats,
) -> None:
    """Sum up the equations of the shared numbers, part by part.

    Parameters
    ----------
    share : (n_frame,)
        How much each frame counts.
    damping : float
        Of the angles, as a share of their information.
    part : (n_frame,) int64
    gain, shift : (n_frame, n_joint, n_shared), (n_frame, n_joint)
        Filled in: ``dq = shift - gain @ d_shared``.
    S, b : (n_part, n_shared, n_shared), (n_part, n_shared)
        Filled in: ``S d_shared = b``, without a prior of the shared numbers.
    """
    n, n_free, n_shared = q.shape[1], free.shape[0], S.shape[1]
    y, r = np.empty(3), np.empty(3)
    A, C = np.empty((n, n)), np.empty((n, n_shared))
    a, at = np.empty(n), np.empty(n_free + 3, dtype=np.int64)
    G = np.empty((3, n_free + 3))
    S[:], b[:] = 0.0, 0.0
    for k in range(q.shape[0]):
        link_frames(chain, frames.R[k], frames.p[k], q[k], room)
        A[:], C[:], a[:] = 0.0, 0.0, 0.0
        own, rhs = S[part[k]], b[part[k]]
        for m in range(chain.link.size):
            if np.isnan(frames.y[k, m, 0]):
                continue
            marker_at(chain, room, m, y)
            squares = 0.0
            for row in range(3):
                r[row] = frames.y[k, m, row] - y[row]
                squares += r[row] ** 2
            w = t_weight(squares, variance[m])
            joint_slopes(chain, room, m, y)
            free_slopes(chain, room, frames.R[k], free, m, y)
            n_at = _shared_slopes(chain, room, m, at, G)
            ws = w * share[k]
            link = chain.link[m]
            way, depth, J = chain.way[link], chain.depth[link], room.by_q
            for row in range(3):
                for e in range(depth):
                    i = way[e]
                    wj = w * J[row, i]
                    a[i] += wj * r[row]
                    for f in range(e + 1):
                        A[i, way[f]] += wj * J[row, way[f]]
                    for f in range(n_at):
                        C[i, at[f]] += wj * G[row, f]
                for e in range(n_at):
                    wg = ws * G[row, e]
                    rhs[at[e]] += wg * r[row]
                    for f in range(n_at):
                        own[at[e], at[f]] += wg * G[row, f]
        for i in range(n):
            for j in range(i):
                A[j, i] = A[i, j]
            A[i, i] = (1.0 + damping) * (A[i, i] + prior.information[i])
            a[i] -= prior.information[i] * (q[k, i] - prior.mean[i])
        gain[k] = np.linalg.solve(A, C)
        shift[k] = np.linalg.solve(A, a)
        own -= share[k] * np.dot(C.T, gain[k])
        rhs -= share[k] * np.dot(C.T, shift[k])


@compiled
def _shared_slopes(chain: MarkerChain, room: Slopes, m: int, at: Integers, G: Floats) -> int:
    """Fill in which shared numbers move a marker, and how; return how many do."""
    n_free, n_at = room.by_free.shape[1], 0
    for j in range(n_free):
        if room.by_free[0, j] != 0.0 or room.by_free[1, j] != 0.0 or room.by_free[2, j] != 0.0:
            at[n_at] = j
            for row in range(3):
                G[row, n_at] = room.by_free[row, j]
            n_at += 1
    for j in range(3):
        at[n_at] = n_free + 3 * m + j
        for row in range(3):
            G[row, n_at] = room.R[chain.link[m], row, j]
        n_at += 1
    return n_at
