"""Torque sums of one trial while it is being read, in whatever portions it comes."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from arm.chain import Chain
from arm.model import Floats
from fitter.data.standstill import is_moving
from fitter.regression_sums.row_sums import BlockSums, add_equations, add_motion

#: Blocks of one trial: enough to measure how residuals hang together, and never more memory than this.
_BLOCKS = 128
_BLOCK_BYTES = 8_000_000
#: How long blocks are at first, in samples, where nobody knows how long the trial will be.
_SHORTEST = 1024


class RunningSums:
    """Sums of one trial that grow with every portion, in memory that does not.

    The result does not depend on the portions, to the last bit. Where the length of the trial is known it is
    parted into blocks of equal length. Where it is not, blocks begin short, and whenever all are full each two
    neighbours become one.

    Parameters
    ----------
    n_joint, n_base : int
    samples : int, optional
        How long the trial is.
    """

    def __init__(self, n_joint: int, n_base: int, samples: int | None = None) -> None:
        room = _BLOCK_BYTES // (8 * n_joint * n_base * (n_base + 2))
        n_block = max(2, min(_BLOCKS, room) // 2 * 2)
        if samples is not None:
            n_block = max(1, min(_BLOCKS, room, samples))
        self._growing = samples is None
        length = n_block * _SHORTEST if samples is None else samples
        self._ends = np.linspace(0, length, n_block + 1).astype(np.intp)
        self._seen = 0
        self._gram = np.zeros((n_block, n_joint, n_base, n_base))
        self._moment, self._row = np.zeros((2, n_block, n_joint, n_base))
        self._power, self._torque, self._count = np.zeros((3, n_block, n_joint))

    def add_motion(
        self,
        chain: Chain,
        columns: NDArray[np.intp],
        q: Floats,
        dq: Floats,
        ddq: Floats,
        tau: Floats,
        rest_speed: float = 0.0,
    ) -> None:
        """Add the samples that follow: motion and torque.

        Parameters
        ----------
        chain : Chain
            Geometry and gravity of the arm.
        columns : (n_base,) int
            The regressor's columns that are wanted.
        q, dq, ddq, tau : (n_sample, n_joint) [rad or m, derivatives, N m or N]
            Of equal length.
        rest_speed : float
            A joint no faster than this is at rest, and its torque says nothing.
        """
        q, dq, ddq, tau = (np.ascontiguousarray(values) for values in (q, dq, ddq, tau))
        for part in self._portions(len(q)):
            ends = self._ends - self._seen
            moving = is_moving(dq[part], rest_speed)
            add_motion(chain, columns, ends, q[part], dq[part], ddq[part], tau[part], moving, *self._arrays())
            self._seen += part.stop - part.start

    def add_equations(self, rows: Floats, tau: Floats, moving: NDArray[np.bool_]) -> None:
        """Add the samples that follow: equations ``rows . p = tau`` that are there already.

        Parameters
        ----------
        rows : (n_sample, n_joint, n_base)
        tau : (n_sample, n_joint) [N m or N]
        moving : (n_sample, n_joint) bool
            Which of them count.
        """
        rows, tau, moving = np.ascontiguousarray(rows), np.ascontiguousarray(tau), np.ascontiguousarray(moving)
        for part in self._portions(len(rows)):
            add_equations(self._ends - self._seen, rows[part], tau[part], moving[part], *self._arrays())
            self._seen += part.stop - part.start

    @property
    def samples(self) -> int:
        """How many samples were added so far, moving or not."""
        return self._seen

    def arrays(self) -> BlockSums:
        """Return gram, moment, power, row, torque and count of the blocks that have samples in them, as copies."""
        used = max(1, int(np.searchsorted(self._ends, self._seen)))
        gram, moment, power, row, torque, count = (values[:used].copy() for values in self._arrays())
        gram += np.swapaxes(np.tril(gram, -1), -1, -2)
        return gram, moment, power, row, torque, count

    def _arrays(self) -> BlockSums:
        return self._gram, self._moment, self._power, self._row, self._torque, self._count

    def _portions(self, n: int) -> Iterator[slice]:
        """Part samples where the blocks are full, and make room for the others."""
        begin = 0
        while begin < n:
            if self._growing and self._seen == self._ends[-1]:
                self._merge()
            end = min(n, begin + int(self._ends[-1]) - self._seen) if self._growing else n
            yield slice(begin, end)
            begin = end

    def _merge(self) -> None:
        """Make one block of each two neighbours."""
        half = (len(self._ends) - 1) // 2
        for values in self._arrays():
            values[:half] = values[0::2] + values[1::2]
            values[half:] = 0.0
        self._ends *= 2
