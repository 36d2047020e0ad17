"""One motion that can be asked for its state at any instant."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Trajectory:
    """The motion of one trial, known at its nodes.

    Parameters
    ----------
    t : ndarray of shape (n,)
        Instants of the nodes [s], rising strictly from 0.
    q, dq, ddq : ndarray of shape (n, n_joint)
        Joint position, velocity and acceleration at the nodes [rad or m, and per s, per s^2].
    method : str
        What the motion came from, as in the ``method`` of `limb/frames`.
    lost : ndarray of bool of shape (n,), optional
        True where samples were lost between a node and the one before it.
    limits : ndarray of shape (n_joint, 2), optional
        What a cubic between two nodes does not go beyond [rad or m], unless a node does.
    begin_s : float
        When the first node is, on the clock by which the motion is asked.

    Raises
    ------
    DataError
        If there are fewer than two nodes, shapes differ, time does not rise from 0, or a value is not finite.
    """

    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    method: str
    lost: Bools | None = None
    limits: Floats | None = None
    begin_s: float = 0.0

    def __post_init__(self) -> None:
        n = len(self.t)
        if n < 2:
            raise DataError(f"the motion has {n} sample(s), expected at least 2")
        shapes = {name: getattr(self, name).shape for name in ("q", "dq", "ddq")}
        if len(set(shapes.values())) > 1 or self.q.shape[:1] != (n,) or self.q.ndim != 2:
            raise DataError(f"the motion has {n} instants and {shapes}, expected (n, n_joint) in all")
        for name in ("t", "q", "dq", "ddq"):
            bad = np.flatnonzero(~np.isfinite(getattr(self, name).reshape(n, -1)).all(axis=1))
            if bad.size:
                raise DataError(f"{name} is not a finite number in sample {bad[0] + 1} of {n}")
        backwards = np.flatnonzero(np.diff(self.t) <= 0.0)
        if backwards.size:
            before, after = self.t[backwards[0]], self.t[backwards[0] + 1]
            place = f"sample {backwards[0] + 2} of {n}"
            raise DataError(f"t goes from {before:.9g} to {after:.9g} s at {place}, expected rising time")
        if self.t[0] != 0.0:
            raise DataError(f"t begins at {self.t[0]:.9g} s, expected 0")

    def within(self, limits: Sequence[tuple[float, float] | None]) -> "Trajectory":
        """Return the motion that keeps to joints' limits between its nodes; the nodes were measured and stay."""
        if all(limit is None for limit in limits):
            return self
        return replace(self, limits=np.array([limit or (-np.inf, np.inf) for limit in limits]))

    @property
    def duration_s(self) -> float:
        """Time from the first node to the last."""
        return float(self.t[-1])

    @cached_property
    def _lost_before(self) -> NDArray[np.int64]:
        """Number of holes before each node."""
        lost = np.zeros(len(self.t), dtype=bool) if self.lost is None else self.lost
        return np.cumsum(lost)

    def at(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the state at any instants.

        Position is the cubic Hermite polynomial through the nodes' q and dq, velocity the one through dq and
        ddq, acceleration is linear between its nodes. All three are exact at the nodes and continuous. Where a
        cubic leaves the limits further than both of its nodes, position stands at the limit or the node.

        Parameters
        ----------
        t : ndarray of shape (k,)
            Instants [s]; before the beginning and after the end the motion stands at its outer nodes.

        Returns
        -------
        q, dq, ddq : ndarray of shape (k, n_joint)
        """
        t = np.clip(t - self.begin_s, 0.0, self.duration_s)
        left = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        width = (self.t[left + 1] - self.t[left])[:, None]
        s = (t - self.t[left])[:, None] / width
        q = _hermite(s, width, self.q[left], self.q[left + 1], self.dq[left], self.dq[left + 1])
        if self.limits is not None:
            ends = np.stack([self.q[left], self.q[left + 1]])
            low, high = self.limits.T
            q = np.clip(q, np.minimum(ends.min(axis=0), low), np.maximum(ends.max(axis=0), high))
        dq = _hermite(s, width, self.dq[left], self.dq[left + 1], self.ddq[left], self.ddq[left + 1])
        return q, dq, (1.0 - s) * self.ddq[left] + s * self.ddq[left + 1]

    def gap_between(self, start_s: float, end_s: float) -> bool:
        """Say whether lost samples are bridged anywhere from start_s to end_s."""
        first = np.searchsorted(self.t, start_s - self.begin_s, side="right") - 1
        last = np.searchsorted(self.t, end_s - self.begin_s, side="left")
        inside = np.clip([first, last], 0, len(self.t) - 1)
        return bool(np.diff(self._lost_before[inside])[0] > 0)


def _hermite(s: Floats, width: Floats, p0: Floats, p1: Floats, v0: Floats, v1: Floats) -> Floats:
    """Cubic Hermite polynomial, written so that s = 0 and s = 1 give p0 and p1 to the last bit."""
    r = 1.0 - s
    return r * r * ((1.0 + 2.0 * s) * p0 + s * width * v0) + s * s * ((3.0 - 2.0 * s) * p1 - r * width * v1)
