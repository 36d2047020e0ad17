"""Velocity and acceleration of a stream of angles, by central differences."""

import numpy as np

from arm.model import Floats


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
        before, now, after = frames[:-2], frames[1:-1], frames[2:]
        dq = (after - before) / (2 * self._dt)
        ddq = (after - 2 * now + before) / self._dt**2
        dq[hold[1:-1]], ddq[hold[1:-1]] = 0.0, 0.0
        for k in np.flatnonzero(~hold[1:-1] & hold[2:]):  # the last frame before a rest was recognised
            dq[k] = (now[k] - before[k]) / self._dt
            ddq[k] = ddq[k - 1] if k > 0 else self._ddq
        if len(ddq):
            self._ddq = ddq[-1]
        self._q, self._held = frames[-2:], hold[-2:]
        return dq, ddq

    def flush(self) -> tuple[Floats, Floats]:
        """Give out the frame that waits, by a one-sided difference, and begin anew."""
        dq, ddq = np.zeros((2, min(len(self._q), 1), len(self._ddq)))
        if self._begun and not self._held[-1]:
            dq[0], ddq[0] = (self._q[1] - self._q[0]) / self._dt, self._ddq
        self._q, self._held, self._begun = self._q[:0], self._held[:0], False
        return dq, ddq
