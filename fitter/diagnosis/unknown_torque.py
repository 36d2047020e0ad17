"""Torques that nobody knows: what holds a stuck joint, and what a jump has done within the step it came in.

Equations are only as good as what is known of the torque in them. These are the shapes of what is not: shapes of
any size are eliminated from the equations, those whose size is known roughly only weigh less (`equation`).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats

#: How long the weight of an equation takes to rise from 0 to 1 at an end [s].
RISE_S = 0.06
#: A joint that is this slow for so long is stuck: one that only turns round is through in a millisecond [s].
STUCK_S = 0.012
#: What holds a stuck joint is as quick as what it is held against; hats this far apart follow it up to 8 Hz [s].
HAT_S = 0.06
#: Where it comes to rest, friction jumps, nobody sees when: near both ends of a rest hats are so far apart [s].
_ENDS_S = (0.0, 0.015, 0.03)
#: Well inside a rest is what lasts this long once this much is cut off at both its ends [s].
_LASTS_S, _CUT_S = 0.1, 0.06


def end_weight(n: int, dt_s: float) -> Floats:
    """Return a weight that rises smoothly from 0 at one end of a motion and falls to 0 at the other."""
    rise = min(max(1, round(RISE_S / dt_s)), n // 2)
    weight = np.ones(n)
    weight[:rise] = np.sin(np.pi / 2.0 * (np.arange(rise) + 0.5) / rise) ** 2
    weight[n - rise :] = weight[:rise][::-1]
    return weight


def end_shapes(n: int, dt_s: float) -> Floats:
    """Return the torques, to be weighted, that the weight makes of the angles' noise at both ends, (n_sample, 4).

    At each it makes an impulse and its derivative.
    """
    weight = end_weight(n, dt_s)
    first, second = np.gradient(weight), np.gradient(np.gradient(weight))
    halves = np.arange(n) < n // 2
    shapes = np.stack([first * halves, second * halves, first * ~halves, second * ~halves], axis=1)
    return np.asarray(shapes / weight[:, None], dtype=np.float64)


def holding_shapes(stuck: NDArray[np.bool_], dt_s: float) -> Floats:
    """Return the shapes of which the torque is made up that holds one joint, (n_sample, n_shape).

    It is as smooth as the drive's is meanwhile: hats `HAT_S` apart.
    """
    n = len(stuck)
    shapes = [np.zeros((n, 0))]
    for begin, end in intervals(stuck):
        knots = _knots(begin, end, dt_s)
        samples = np.arange(begin, end)
        for k in range(len(knots)):
            hat = np.zeros(n)
            hat[begin:end] = np.interp(samples, knots, np.eye(len(knots))[k])
            shapes.append(hat[:, None])
    return np.concatenate(shapes, axis=1)


def rest_shapes(stuck: NDArray[np.bool_], dt_s: float) -> Floats:
    """Return torques that last as long as one long rest of a joint each, (n_sample, n_rest)."""
    rests = [(begin, end) for begin, end in intervals(stuck) if (end - begin) * dt_s >= _LASTS_S + 2.0 * _CUT_S]
    shapes = np.zeros((len(stuck), len(rests)))
    for k, (begin, end) in enumerate(rests):
        shapes[begin:end, k] = 1.0
    return shapes


def _knots(begin: int, end: int, dt_s: float) -> Floats:
    """Return where the hats of a rest stand, in samples: close at its ends, not so close between."""
    near = np.array(_ENDS_S) / dt_s
    near = near[(near == 0.0) | (near < 0.5 * (end - 1 - begin))]
    low, high = begin + near[-1], end - 1 - near[-1]
    count = max(1, round((high - low) * dt_s / HAT_S)) + 1
    return np.concatenate([begin + near[:-1], np.linspace(low, high, count), end - 1 - near[:-1][::-1]])


def lasting(stuck: NDArray[np.bool_], dt_s: float) -> NDArray[np.bool_]:
    """Return what of a mask (n_sample, n_joint) lasts: a joint that passes through zero speed is not stuck."""
    kept = np.zeros(stuck.shape, dtype=np.bool_)
    for j in range(stuck.shape[1]):
        for begin, end in intervals(stuck[:, j]):
            if end - begin >= STUCK_S / dt_s:
                kept[begin:end, j] = True
    return kept


def intervals(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return where a mask (n_sample,) is set: the first sample of each run, and the first behind it."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return list(zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True))


def inner_rests(stuck: NDArray[np.bool_], dt_s: float) -> list[slice]:
    """Return the samples well inside the rests of one joint, (n_sample,): there it does stand still."""
    cut = round(_CUT_S / dt_s)
    return [
        slice(begin + cut, end - cut)
        for begin, end in intervals(stuck)
        if (end - begin - 2 * cut) * dt_s >= _LASTS_S
    ]


def jump_shapes(jumps: Sequence[tuple[float, int, float]], n: int, n_joint: int) -> Floats:
    """Return the impulses by which jumps of the torque may be off, one standard error each, (n, n_joint, n_jump).

    A jump comes at some instant between two samples, and a fast loop takes part of it back before the next.

    Parameters
    ----------
    jumps : sequence of (sample, joint, error)
        As `Motion.jumps` has them.
    n, n_joint : int
    """
    shapes = np.zeros((n, n_joint, len(jumps)))
    for k, (at, joint, error) in enumerate(jumps):
        first = min(int(at), n - 1)
        part = at - first
        shapes[first, joint, k] = (1.0 - part) * error
        shapes[min(first + 1, n - 1), joint, k] += part * error
    return shapes
