"""Velocity and acceleration of a stream of angles, by central differences."""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled


class CentralDifferences:
    """Differentiates angles as they come; what it gives out is one frame behind what it was given.

    While the arm is held at rest, both derivatives are zero. When a rest has been recognised velocities jump to
    zero; that jump is no motion, so no difference is taken across it.

    Parameters
    ----------
    dt_s : float
    n_joint : int
    """

    def __init__(self, dt_s: float, n_joint: int) -> None:
        self._dt = dt_s
        self._q = np.empty((0, n_joint))  # at most two frames: the last one given out, and the one that waits
        self._held = np.empty(0, dtype=bool)
        self._ddq = np.zeros(n_joint)
        self._begun = False

    def push(self, q: Floats, held: bool) -> tuple[Floats, Floats]:
        """Take in angles and give out derivatives: of the frame that waited and of all of these but the last.

        Parameters
        ----------
        q : (n, n_joint)
        held : bool
            The arm is held at rest in all of these frames.

        Returns
        -------
        dq, ddq : (m, n_joint)
            m is n, or n - 1 where no frame waited.
        """
        frames = np.vstack([self._q, q])
        hold = np.concatenate([self._held, np.full(len(q), held)])
        if not self._begun:
            if len(frames) < 2:
                self._q, self._held = frames, hold
                return frames[:0], frames[:0]
            first = frames[:1] if hold[0] else 2 * frames[:1] - frames[1:2]  # no jump at the start
            frames, hold = np.vstack([first, frames]), np.concatenate([hold[:1], hold])
            self._begun = True
        dq, ddq = np.empty((2, len(frames) - 2, len(self._ddq)))
        _differences(frames, hold, self._dt, self._ddq, dq, ddq)
        self._q, self._held = frames[-2:], hold[-2:]
        return dq, ddq

    def flush(self) -> tuple[Floats, Floats]:
        """Give out the frame that waits, by a one-sided difference, and begin anew."""
        dq, ddq = np.zeros((2, min(len(self._q), 1), len(self._ddq)))
        if self._begun and not self._held[-1]:
            dq[0], ddq[0] = (self._q[1] - self._q[0]) / self._dt, self._ddq
        self._q, self._held, self._begun = self._q[:0], self._held[:0], False
        return dq, ddq


@compiled
def _differences(
    q: Floats, held: NDArray[np.bool_], dt: float, last_ddq: Floats, dq: Floats, ddq: Floats
) -> None:
    """Fill in the derivatives of all frames but the first and the last; carry ``last_ddq`` on."""
    for k in range(dq.shape[0]):
        before, now, after = q[k], q[k + 1], q[k + 2]
        for j in range(dq.shape[1]):
            if held[k + 1]:
                dq[k, j] = ddq[k, j] = 0.0
            elif held[k + 2]:  # the last frame before a rest was recognised
                dq[k, j] = (now[j] - before[j]) / dt
                ddq[k, j] = last_ddq[j]
            else:
                dq[k, j] = (after[j] - before[j]) / (2 * dt)
                ddq[k, j] = (after[j] - 2 * now[j] + before[j]) / dt**2
            last_ddq[j] = ddq[k, j]
