r"""Errors in variables: the direction ``x`` that annuls noisy rows, and intervals of the ratios of its components.

Rows ``R_k = (true row) + noise`` with ``R_k x = 0`` but for the noise, whose covariance is ``sigma^2 N_k``. The
likeliest direction minimises ``sum (R_k x)^2 / x' N_k x`` (total least squares, Van Huffel and Vandewalle 1991).
All directions that are no less likely than a quantile allows form a quadratic cone,

.. math:: x^T (G - c N)\, x \le 0, \qquad c = \hat\sigma^2 (1 + F_{1, \nu} / \nu).

A ratio of two linear functions of x has an interval in it, which need not be bounded (Fieller 1954): then the rows
do not tell the ratio, however small a formal standard error is. Where a second direction annuls the rows nearly as
well, this quantile is too small; c is then that of all directions which leave no more than the noise,
:math:`\chi^2_\nu / \nu` (Anderson and Rubin 1949).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
import scipy.linalg

from arm.model import Floats
from fitter.controller.row_noise import RowNoise

#: Weights by the noise of the last direction are renewed this often; three times settle them to a percent.
_ROUNDS = 6
#: Relative size of the least noise that a column is taken to have: rounding of double sums.
_ROUNDING = 1e-12
#: A direction stands out if the next one is rejected by this F per free component (Staiger and Stock 1997).
_STRONG = 10.0
#: Probability with which an interval holds the truth.
CONFIDENCE = 0.95


@dataclass(frozen=True)
class HomogeneousFit:
    """The direction that annuls some rows best.

    Attributes
    ----------
    x : (n_column,)
    gram, noise : (n_column, n_column)
        Weighted sums of the rows' products, and of what noise of one unit makes of them; ``x' noise x`` is the
        number of rows.
    sigma : float
        The noise, in its unit; 1 where it is what it was said to be.
    dof : float
        Independent rows less free components of x.
    next_sigma : float
        That of the next direction.
    """

    x: Floats
    gram: Floats
    noise: Floats
    sigma: float
    dof: float
    next_sigma: float

    @property
    def threshold(self) -> float:
        """What ``x' gram x / x' noise x`` may be within an interval of 95 %."""
        noise = max(self.sigma**2, 1.0) * float(scipy.stats.chi2.ppf(CONFIDENCE, self.dof)) / self.dof
        if self.dof * (self.next_sigma**2 - noise) > _STRONG * (len(self.x) - 1.0):
            return self.sigma**2 * (1.0 + float(scipy.stats.f.ppf(CONFIDENCE, 1, self.dof)) / self.dof)
        return noise

    def ratio(self, over: Floats, under: Floats) -> tuple[float, tuple[float, float] | None]:
        """Return a ratio ``over . x / under . x`` and its 95 % interval, None where it is unbounded.

        Parameters
        ----------
        over, under : (n_column,)
        """
        value = float(over @ self.x) / float(under @ self.x)
        size = 1.0 / np.sqrt(np.diag(self.noise))
        both = np.stack([over, under]) * size
        rest = scipy.linalg.null_space(both)
        axes = np.hstack([np.linalg.pinv(both), rest])  # x = axes (over . x, under . x, the rest)
        Q = axes.T @ ((self.gram - self.threshold * self.noise) * np.outer(size, size)) @ axes
        if rest.shape[1]:
            if np.linalg.eigvalsh(Q[2:, 2:])[0] <= 0.0:
                return value, None
            Q = Q[:2, :2] - Q[:2, 2:] @ np.linalg.solve(Q[2:, 2:], Q[2:, :2])
        a, b, discriminant = Q[0, 0], Q[0, 1], Q[0, 1] ** 2 - Q[0, 0] * Q[1, 1]
        if a <= 0.0 or discriminant < 0.0:
            return value, None
        return value, (float((-b - np.sqrt(discriminant)) / a), float((-b + np.sqrt(discriminant)) / a))


def homogeneous_fit(rows: Sequence[Floats], noise: Sequence[RowNoise], alike: float) -> HomogeneousFit:
    """Return the direction that annuls some rows best.

    Parameters
    ----------
    rows : sequence of (n_row, n_column)
        Of each trial.
    noise : sequence of RowNoise
        Of each trial's rows.
    alike : float
        How many rows have the same noise: independent ones are fewer by this factor.
    """
    R = np.concatenate(rows)
    n, ends = R.shape[1], np.cumsum([len(part) for part in rows])[:-1]

    def sums(weights: Floats) -> tuple[Floats, Floats]:
        parts = zip(noise, np.split(weights, ends), strict=True)
        N = np.sum([one.gram(part) for one, part in parts], axis=0)
        size = np.sqrt(np.diag(N))
        N += _ROUNDING * np.outer(size, size) * np.eye(n)
        return np.asarray((R * weights[:, None]).T @ R), np.asarray(N)

    plain = np.sqrt(np.diag(sums(np.ones(len(R)))[1]))
    weights = 1.0 / np.concatenate([one.variance(1.0 / plain) for one in noise])
    for _ in range(_ROUNDS):
        G, N = sums(weights)
        scale = np.outer(plain, plain)
        squares, axes = scipy.linalg.eigh(G / scale, N / scale, subset_by_index=[0, 1])
        x = axes[:, 0] / plain
        weights = 1.0 / np.concatenate([one.variance(x) for one in noise])
    G, N = sums(weights)
    dof = max(len(R) / alike - n + 1.0, 1.0)
    sigma = float(np.sqrt(max(x @ G @ x, 0.0) / max(len(R) - n + 1.0, 1.0)))
    return HomogeneousFit(x, G, N, sigma, dof, float(np.sqrt(max(squares[1], 0.0))))
