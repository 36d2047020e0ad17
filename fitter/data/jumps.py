"""Where a sampled torque jumps: a controller that is given a new target asks for another torque from then on."""

import numpy as np

from arm.model import Floats

#: A torque that changes from one sample to the next by this many times its usual change has jumped …
_MUCH = 20.0
#: … if it changed by this many times less in the samples before: what changes fast for a while has not. What
#: follows tells nothing, for a fast loop takes most of a jump back within a sample or two.
_SUDDEN, _BEFORE = 4.0, 2


def jumps(torque: Floats) -> Floats:
    """Return by how much a torque has jumped up to a sample since the one before; 0 where it changed smoothly.

    Parameters
    ----------
    torque : ndarray of shape (n, n_joint)

    Returns
    -------
    ndarray of shape (n, n_joint)
    """
    changes = np.diff(torque, axis=0, prepend=torque[:1])
    size = np.abs(changes)
    jumped = size > _MUCH * np.maximum(np.median(size, axis=0), np.mean(size, axis=0))
    for back in range(1, _BEFORE + 1):
        before = np.vstack([np.zeros((back, size.shape[1])), size[:-back]])
        jumped &= size > _SUDDEN * before
    return np.where(jumped, changes, 0.0)


def midway_at_jumps(torque: Floats) -> Floats:
    """Return a sampled torque that jumps at the instant of a sample, not half a step before it.

    Between the samples of a filter or an integration a jump would lie midway, half a step early: a percent of
    every inertia where samples are two milliseconds apart and most of the motion's impulse is in the jump.

    Parameters
    ----------
    torque : ndarray of shape (n, n_joint)

    Returns
    -------
    ndarray of shape (n, n_joint)
    """
    return np.asarray(torque - 0.5 * jumps(torque), dtype=np.float64)
