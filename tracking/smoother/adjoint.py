"""The filter's adjoint: what later readings say of an earlier estimate, carried backwards (Bryson and Frazier).

A vector and a matrix are carried: by how much later readings move the estimate, through its covariance, and by how
much they shrink that. ``carry_back`` is the transpose of `tracking.kalman.kalman_step.predict`, ``give_back`` that
of the readings of an instant.
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.kalman.kalman_step import Taken, forgetting
from tracking.model.course import Course
from tracking.model.observation import Observation
from tracking.model.stationary_process import transition

#: A difference smaller than this fraction of its terms has lost five of its sixteen digits.
_DIGITS = 1e-5


@compiled
def reported_variance(entries: np.ndarray, P: Floats, shrink: Floats, variance: Floats) -> None:
    """Fill in the diagonal of ``P - P shrink P`` for some entries; NaN where hardly a digit of P is left."""
    size = P.shape[0]
    product = np.empty(size)
    for i in range(entries.size):
        a = entries[i]
        product[:] = 0.0
        for c in range(size):  # along the rows of a symmetric matrix
            for b in range(size):
                product[b] += shrink[c, b] * P[a, c]
        less = 0.0
        for b in range(size):
            less += product[b] * P[a, b]
        left = P[a, a] - less
        variance[i] = left if left > _DIGITS * P[a, a] else np.nan


@compiled
def give_back(
    of: Observation,
    course: Course,
    taken: Taken,
    later: Floats,
    shrink: Floats,
    with_variance: bool,
    error: Floats,
    precision: Floats,
) -> None:
    """Carry the adjoint from after the readings of instant k to before them, the last one first."""
    n_channel, size = course.noise.size, later.size
    one, column = np.ones(size), np.zeros(1, dtype=np.int64)
    for row in range(taken.total.size - 1, -1, -1):
        total, gain = taken.total[row], taken.gain[row]
        if not np.isfinite(total):
            continue
        if row < n_channel:
            columns, slope = of.columns[row, : of.n_column[row]], taken.slope[row]
        else:
            column[0] = 3 * (row - n_channel) + 1
            columns, slope = column[:1], one
        pull = taken.miss[row] / total
        for a in range(size):
            pull += gain[a] * later[a]
        error[row] = pull
        for c in columns:
            later[c] -= slope[c] * pull
        if with_variance:
            precision[row] = shrink_back(shrink, gain, total, slope, columns)


@compiled
def shrink_back(shrink: Floats, gain: Floats, total: float, slope: Floats, columns: np.ndarray) -> float:
    """Replace S by ``(I - K h)^T S (I - K h) + h^T h / total``, h being the sparse row ``slope``.

    Returns
    -------
    float
        ``K^T S K + 1 / total``, the variance of the reading's smoothing error.
    """
    size = gain.size
    product = np.zeros(size)
    square = 1.0 / total
    for b in range(size):  # along the rows of a symmetric matrix
        for a in range(size):
            product[a] += shrink[b, a] * gain[b]
    for a in range(size):
        square += product[a] * gain[a]
    for c in columns:
        for a in range(size):
            shrink[a, c] -= product[a] * slope[c]
            shrink[c, a] -= product[a] * slope[c]
    for c in columns:
        for b in columns:
            shrink[b, c] += square * slope[b] * slope[c]
    return square


@compiled
def carry_back(
    of: Observation, course: Course, k: int, at: Floats, later: Floats, shrink: Floats, with_variance: bool
) -> None:
    """Carry the adjoint from instant k to k - 1: the transpose of `predict`."""
    dt, n = course.dt, course.push.size
    kept = np.exp(-dt / course.memory_s)
    if of.base_column >= 0:
        for axis in range(3):
            forget_back(later, shrink, of.base_column + axis, kept, with_variance)
    if of.lack_column >= 0:
        for channel in range(course.noise.size):
            forget_back(later, shrink, of.lack_column + channel, kept, with_variance)
    for s in range(of.corner.size):
        if of.settled_column[s] < 0:
            continue
        for axis in range(3):
            channel = 3 * s + axis
            o, settled, corner_at = 3 * n + channel, of.settled_column[s] + axis, of.corner_column[s]
            corner, stands = forgetting(of, course, k, channel, at)
            add_back(later, shrink, settled, o, dt * corner, with_variance)
            if corner_at >= 0:
                add_back(later, shrink, corner_at, o, -dt * stands, with_variance)
    for j in range(n):
        q = 3 * j
        step = transition(course.rate[j], dt)
        carry_joint_back(later, step, q)
        if with_variance:
            for c in range(later.size):
                carry_joint_back(shrink[:, c], step, q)
            for c in range(later.size):
                carry_joint_back(shrink[c], step, q)


@compiled
def forget_back(later: Floats, shrink: Floats, at: int, kept: float, with_variance: bool) -> None:
    """Carry the adjoint of an entry that decays."""
    later[at] *= kept
    if with_variance:
        shrink[at, :] *= kept
        shrink[:, at] *= kept


@compiled
def carry_joint_back(values: Floats, step: tuple[float, float, float, float, float, float], q: int) -> None:
    """Replace the entries of q, dq, ddq by the transposed transition of theirs."""
    qv, qa, vv, va, av, aa = step
    at, v, a = values[q], values[q + 1], values[q + 2]
    values[q + 1], values[q + 2] = qv * at + vv * v + av * a, qa * at + va * v + aa * a


@compiled
def add_back(later: Floats, shrink: Floats, to: int, source: int, factor: float, with_variance: bool) -> None:
    """Add ``factor`` times entry ``source`` to entry ``to``, of the vector and on both sides of the matrix."""
    later[to] += factor * later[source]
    if with_variance:
        for b in range(later.size):
            shrink[to, b] += factor * shrink[source, b]
        for b in range(later.size):
            shrink[b, to] += factor * shrink[b, source]
