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


def end_weight(n: int, dt_s: float) -> Floats:
    """Return a weight that rises smoothly from 0 at one end of a motion and falls to 0 at the other."""
    rise = min(max(1, round(RISE_S / dt_s)), n // 2)
    weight = np.ones(n)
    weight[:rise] = np.sin(np.pi / 2.0 * (np.arange(rise) + 0.5) / rise) ** 2
    weight[n - rise :] = weight[:rise][::-1]
    return weight


def holding_shapes(stuck: NDArray[np.bool_], dt_s: float) -> Floats:
    """Return the shapes of which the unknown torque on one joint is made up, (n_sample, n_shape).

    What holds a stuck joint can be any torque, smooth as the drive's is meanwhile: hats `HAT_S` apart. At both
    ends of the motion the weight makes of the angles' noise an impulse and its derivative.
    """
    n = len(stuck)
    weight = end_weight(n, dt_s)
    first, second = np.gradient(weight), np.gradient(np.gradient(weight))
    halves = np.arange(n) < n // 2
    shapes = [first * halves, second * halves, first * ~halves, second * ~halves]
    for begin, end in _intervals(stuck):
        knots = _knots(begin, end, dt_s)
        samples = np.arange(begin, end)
        for k in range(len(knots)):
            hat = np.zeros(n)
            hat[begin:end] = np.interp(samples, knots, np.eye(len(knots))[k])
            shapes.append(hat)
    return np.stack(shapes, axis=1)


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
        for begin, end in _intervals(stuck[:, j]):
            if end - begin >= STUCK_S / dt_s:
                kept[begin:end, j] = True
    return kept


def _intervals(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return list(zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True))


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
