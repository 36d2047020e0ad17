"""Velocity and acceleration of a stream of angles, by central differences."""

import numpy as np

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
        self._known = 0  # frames before: none, only the one that waits, or also the last one given out
        self._held = False  # the frame that waits
        self._recent = np.zeros((2, n_joint))  # the last one given out, and the one that waits
        self._ddq = np.zeros(n_joint)

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        self._dt = dt_s

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
        n = len(q)
        dq, ddq = np.empty((2, n if self._known else max(n - 1, 0), len(self._ddq)))
        if n:
            _differences(q, held, self._known, self._held, self._recent, self._dt, self._ddq, dq, ddq)
            self._known, self._held = min(self._known + n, 2), held
        return dq, ddq

    def flush(self) -> tuple[Floats, Floats]:
        """Give out the frame that waits, by a one-sided difference, and begin anew."""
        dq, ddq = np.zeros((2, min(self._known, 1), len(self._ddq)))
        if self._known == 2 and not self._held:
            dq[0], ddq[0] = (self._recent[1] - self._recent[0]) / self._dt, self._ddq
        self._known, self._held = 0, False
        return dq, ddq


@compiled
def _differences(
    q: Floats,
    held: bool,
    known: int,
    was_held: bool,
    recent: Floats,
    dt: float,
    last_ddq: Floats,
    dq: Floats,
    ddq: Floats,
) -> None:
    """Fill in the derivatives of the frame that waited and of all but the last; carry ``recent, last_ddq`` on."""
    given = 0
    for k in range(q.shape[0]):
        for j in range(q.shape[1]):
            before, now, after = recent[0, j], recent[1, j], q[k, j]
            recent[0, j], recent[1, j] = now, after
            if known == 0:
                continue
            if known == 1:  # no jump at the start
                before = now if was_held else 2 * now - after
            if was_held:
                dq[given, j] = ddq[given, j] = 0.0
            elif held:  # the last frame before a rest was recognised
                dq[given, j] = (now - before) / dt
                ddq[given, j] = last_ddq[j]
            else:
                dq[given, j] = (after - before) / (2 * dt)
                ddq[given, j] = (after - 2 * now + before) / dt**2
            last_ddq[j] = ddq[given, j]
        given += known > 0
        known, was_held = min(known + 1, 2), held
