"""Noise of rows that are ordered by frequency: draws of it, averaged over neighbours."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats

#: Frequencies over which the noise of rows is averaged.
_AVERAGED = 9


@dataclass(frozen=True)
class RowNoise:
    """What the errors of rows are, by draws of them; no covariance of single rows is ever in memory.

    Attributes
    ----------
    drawn : (n_draw, n_frequency, n_joint, n_column)
    """

    drawn: Floats

    def variance(self, x: Floats) -> Floats:
        """Return the variance of ``row . x``, (n_frequency * n_joint,)."""
        low, high = self._windows()
        squares = np.mean((self.drawn @ x) ** 2, axis=0)
        total = np.concatenate([np.zeros((1, squares.shape[1])), np.cumsum(squares, axis=0)])
        return np.asarray(((total[high] - total[low]) / (high - low)[:, None]).ravel())

    def gram(self, weights: Floats) -> Floats:
        """Return the weighted sum of all rows' covariances, (n_column, n_column).

        Parameters
        ----------
        weights : (n_frequency * n_joint,)
        """
        low, high = self._windows()
        n_draw, n_frequency, n_joint, n = self.drawn.shape
        shares = weights.reshape(n_frequency, n_joint) / (high - low)[:, None]
        edges = np.zeros((n_frequency + 1, n_joint))
        np.add.at(edges, low, shares)
        np.add.at(edges, high, -shares)
        each = np.sqrt(np.maximum(np.cumsum(edges, axis=0)[:-1], 0.0) / n_draw)
        rows = (self.drawn * each[..., None]).reshape(-1, n)
        return np.asarray(rows.T @ rows)

    def _windows(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the first frequency of each one's neighbours, and the first beyond them."""
        n = self.drawn.shape[1]
        k = np.arange(n)
        return np.maximum(k - _AVERAGED // 2, 0), np.minimum(k + _AVERAGED // 2 + 1, n)
