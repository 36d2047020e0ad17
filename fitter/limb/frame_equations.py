"""Normal equations of one frame's angles: markers summed link by link, and links from the tips to the base.

A joint moves a point at ``y`` by ``v + w × y``, whatever link the point rides on: a twist. So ``J^T W J`` of all
markers on a link is what a rigid body of point masses at the markers, of their weights, has for a mass matrix, and
of a tree it is found as that is: by the composite rigid bodies of what each joint moves (Walker and Orin 1982).
That is a dozen sums a marker, however many joints move it.
"""

import numpy as np

from arm.marker_kinematics import MarkerChain, Slopes, link_frames
from arm.model import Floats
from fitter.limb.marker_observations import AnglePrior, Frames
from fitter.limb.normal_equations import t_cost, t_weight
from limbcal.compiled import compiled

#: What is summed of the markers on a link, about frame 0's origin: weight, weight times place (3) and times its
#: products xx yy zz xy xz yz, pull (3) and its moment (3).
_SUMS = 16


@compiled
def frame_equations(
    chain: MarkerChain,
    frames: Frames,
    k: int,
    variance: Floats,
    prior: AnglePrior,
    q: Floats,
    room: Slopes,
    A: Floats,
    a: Floats,
) -> float:
    """Fill in the normal equations ``A dq = a`` of one frame; return its cost."""
    link_frames(chain, frames.R[k], frames.p[k], q, room)
    sums = np.zeros((q.size, _SUMS))
    total = _sum_markers(chain, frames, k, variance, room, sums)
    _project(chain, room, sums, A, a)
    for i in range(q.size):
        for j in range(i):
            A[j, i] = A[i, j]
        away = q[i] - prior.mean[i]
        total += prior.information[i] * away**2
        A[i, i] += prior.information[i]
        a[i] -= prior.information[i] * away
    return total


@compiled
def _sum_markers(
    chain: MarkerChain, frames: Frames, k: int, variance: Floats, room: Slopes, sums: Floats
) -> float:
    """Sum up a frame's markers on each link, (n, 16), and return their cost."""
    n = sums.shape[0]
    R, o, far, y, place, total = room.R, room.o, room.far, frames.y, chain.place, 0.0
    for m in range(chain.link.size):
        if np.isnan(y[k, m, 0]):
            continue
        i = chain.link[m]
        x0 = o[i, 0] + R[i, 0, 0] * place[m, 0] + R[i, 0, 1] * place[m, 1] + R[i, 0, 2] * place[m, 2]
        x1 = o[i, 1] + R[i, 1, 0] * place[m, 0] + R[i, 1, 1] * place[m, 1] + R[i, 1, 2] * place[m, 2]
        x2 = o[i, 2] + R[i, 2, 0] * place[m, 0] + R[i, 2, 1] * place[m, 1] + R[i, 2, 2] * place[m, 2]
        r0, r1, r2 = y[k, m, 0] - x0, y[k, m, 1] - x1, y[k, m, 2] - x2
        squares = r0**2 + r1**2 + r2**2
        total += t_cost(squares, variance[m])
        w = t_weight(squares, variance[m])
        x0, x1, x2 = x0 - far[n, 0], x1 - far[n, 1], x2 - far[n, 2]
        sums[i, 0] += w
        sums[i, 1] += w * x0
        sums[i, 2] += w * x1
        sums[i, 3] += w * x2
        sums[i, 4] += w * x0 * x0
        sums[i, 5] += w * x1 * x1
        sums[i, 6] += w * x2 * x2
        sums[i, 7] += w * x0 * x1
        sums[i, 8] += w * x0 * x2
        sums[i, 9] += w * x1 * x2
        sums[i, 10] += w * r0
        sums[i, 11] += w * r1
        sums[i, 12] += w * r2
        sums[i, 13] += w * (x1 * r2 - x2 * r1)
        sums[i, 14] += w * (x2 * r0 - x0 * r2)
        sums[i, 15] += w * (x0 * r1 - x1 * r0)
    return total


@compiled
def _project(chain: MarkerChain, room: Slopes, sums: Floats, A: Floats, a: Floats) -> None:
    """Fill in the lower triangle of ``A`` and ``a``; ``sums`` becomes that of all that each joint moves."""
    n, R, o, far = sums.shape[0], room.R, room.o, room.far
    twist = np.zeros((n, 6))  # w, v about frame 0's origin
    for i in range(n):
        z0, z1, z2 = R[i, 0, 2], R[i, 1, 2], R[i, 2, 2]
        if chain.revolute[i]:
            c0, c1, c2 = o[i, 0] - far[n, 0], o[i, 1] - far[n, 1], o[i, 2] - far[n, 2]
            twist[i, 0], twist[i, 1], twist[i, 2] = z0, z1, z2
            twist[i, 3], twist[i, 4], twist[i, 5] = c1 * z2 - c2 * z1, c2 * z0 - c0 * z2, c0 * z1 - c1 * z0
        else:
            twist[i, 3], twist[i, 4], twist[i, 5] = z0, z1, z2
    for i in range(n - 1, -1, -1):
        parent = chain.parent[i]
        if parent >= 0:
            for s in range(_SUMS):
                sums[parent, s] += sums[i, s]
        weight, x0, x1, x2 = sums[i, 0], sums[i, 1], sums[i, 2], sums[i, 3]
        xx, yy, zz, xy, xz, yz = sums[i, 4], sums[i, 5], sums[i, 6], sums[i, 7], sums[i, 8], sums[i, 9]
        w0, w1, w2, v0, v1, v2 = twist[i, 0], twist[i, 1], twist[i, 2], twist[i, 3], twist[i, 4], twist[i, 5]
        f0 = weight * v0 + w1 * x2 - w2 * x1
        f1 = weight * v1 + w2 * x0 - w0 * x2
        f2 = weight * v2 + w0 * x1 - w1 * x0
        g0 = (yy + zz) * w0 - xy * w1 - xz * w2 + x1 * v2 - x2 * v1
        g1 = (xx + zz) * w1 - xy * w0 - yz * w2 + x2 * v0 - x0 * v2
        g2 = (xx + yy) * w2 - xz * w0 - yz * w1 + x0 * v1 - x1 * v0
        a[i] = v0 * sums[i, 10] + v1 * sums[i, 11] + v2 * sums[i, 12]
        a[i] += w0 * sums[i, 13] + w1 * sums[i, 14] + w2 * sums[i, 15]
        for j in range(i + 1):
            A[i, j] = 0.0
        j = i
        while j >= 0:
            A[i, j] = (
                twist[j, 0] * g0 + twist[j, 1] * g1 + twist[j, 2] * g2
                + twist[j, 3] * f0 + twist[j, 4] * f1 + twist[j, 5] * f2
            )  # fmt: skip
            j = chain.parent[j]
