"""Least squares where columns may be collinear, and when a residual differs from zero.

With the tolerances, probabilities and limits that all parts of a diagnosis share.
"""

from dataclasses import dataclass

import numpy as np
import scipy
import scipy.fft
import scipy.linalg
from numpy.typing import NDArray

from arm.model import Floats

#: Relative rounding of a sum of squares: some thousand additions in double precision. Columns that are this
#: near to depending on others, in terms of the normal equations, do so.
ROUNDED = 1e-12
#: Relative step of a central difference: its error is least at the cube root of rounding (Press et al. 2007, 5.7).
SLOPE = float(np.cbrt(ROUNDED))
#: As good as nothing: it keeps a quotient finite.
TINY = 1e-300
#: Probability with which what is nothing passes for nothing, the field's usual one, and its standard errors.
CONFIDENCE = 0.95
EQUAL_SIGMAS = float(scipy.special.ndtri(0.5 + 0.5 * CONFIDENCE))
#: Standard deviation of a normal distribution in units of its median absolute deviation.
MAD_STD = 1.4826
#: Standard deviations at which one of a run's some thousand samples is hardly ever by chance: one in 16 000.
SIGMAS = 4.0
#: A variance clearly exceeds another if it is this multiple of it: 3 dB.
CLEAR_RATIO = 2.0
#: Odds of a false cause, a hundred to one after Bonferroni over what was tried, are log(100) nats.
ODDS_NATS = float(np.log(100.0))
#: Length of a block [s]. Within it residuals count as correlated: joint velocities of measured runs have
#: equivalent bandwidths of 0.5 to 1.2 Hz (decision 22).
BLOCK_S = 1.0
#: Share of a torque, a variance or a gain that is negligible, a convention: models of arms are seldom that good.
NEGLIGIBLE = 0.01
#: Share of what is to be explained that may stay unexplained, a convention.
UNEXPLAINED = 0.05
#: Number of candidates that are refined after a coarse search, a convention.
N_REFINED = 5
#: Greatest number of causes: a machine has more, but no run identifies more.
MOST_CAUSES = 6
#: Steps of an iteration at the most: Newton's doubles its digits with each, reweighting gains one in one or two.
ITERATIONS = 20
#: Relative change, or gain [nats], at which an iteration has settled, and the least part of a step: far below one
#: standard error, which is half a nat.
SETTLED = 1e-3


@dataclass(frozen=True)
class Normal:
    """Normal equations: products of columns (k, k), with the right-hand side (k,), and its square."""

    gram: Floats
    rhs: Floats
    square: float

    def plus(self, more: "Normal") -> "Normal":
        """Return the normal equations of these rows and others."""
        return Normal(self.gram + more.gram, self.rhs + more.rhs, self.square + more.square)

    def of(self, free: NDArray[np.bool_]) -> "Normal":
        """Return the normal equations of those factors that are free (k,); the others have no say."""
        return Normal(self.gram * np.outer(free, free), self.rhs * free, self.square)

    def sum_of_squares(self, x: Floats) -> float:
        """Return the sum of squares that factors (k,) leave."""
        square_sum = float(x @ self.gram @ x) - 2.0 * float(self.rhs @ x) + self.square
        return max(square_sum, ROUNDED * self.square, np.finfo(np.float64).tiny)


def scaled_lstsq(A: Floats, y: Floats) -> Floats:
    """Return the least-squares answer by the normal equations; see `solved`."""
    return solved(A.T @ A, A.T @ y)


def solved(gram: Floats, rhs: Floats) -> Floats:
    """Return the answer to normal equations, columns scaled to length one first.

    Where columns depend on one another it is the shortest answer.

    Parameters
    ----------
    gram : (n, n)
    rhs : (n,)
    """
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    eigenvalues, axes = np.linalg.eigh(gram / np.outer(size, size))
    kept = eigenvalues > ROUNDED * max(float(eigenvalues.max(initial=0.0)), TINY)
    axes = axes[:, kept]
    return np.asarray(axes @ ((axes.T @ (rhs / size)) / eigenvalues[kept]) / size, dtype=np.float64)


def own_square(gram: Floats) -> float:
    """Return the square of the last column that no others make, by their products (n, n)."""
    others = gram[:-1, :-1]
    return max(0.0, float(gram[-1, -1] - gram[-1, :-1] @ solved(others, gram[:-1, -1])))


def compensated(gram: Floats, rhs: Floats, noise_gram: Floats, noise_rhs: Floats) -> Floats:
    """Return the answer to normal equations that noise has a part in.

    Parameters
    ----------
    gram, noise_gram : (k, k)
        Of the design, and of what noise makes of it.
    rhs, noise_rhs : (k,)
        The products with the right-hand side.
    """
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    eigenvalues, axes = np.linalg.eigh(gram / np.outer(size, size))
    kept = eigenvalues > ROUNDED * max(float(eigenvalues.max(initial=0.0)), TINY)
    root = axes[:, kept] / np.sqrt(eigenvalues[kept]) / size[:, None]  # root^T gram root = 1
    share, within = np.linalg.eigh(root.T @ noise_gram @ root)
    root = root @ within
    # No direction is enlarged by more: where all is noise, nothing can be corrected.
    kept_share = np.maximum(1.0 - share, 1.0 / CLEAR_RATIO)
    return np.asarray(root @ ((root.T @ (rhs - noise_rhs)) / kept_share), dtype=np.float64)


def orthonormal(columns: Floats) -> Floats:
    """Return an orthonormal basis of what columns span."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(size > 0.0, size, 1.0)  # of a rest of one sample one B-spline is zero
    Q, R, _ = scipy.linalg.qr(scaled, mode="economic", pivoting=True, check_finite=False)
    size = np.abs(np.diag(R))
    return np.ascontiguousarray(Q[:, : len(size)][:, size > np.sqrt(ROUNDED) * size[0]])


def singular(columns: Floats) -> tuple[Floats, Floats]:
    """Return the left singular vectors of columns and their values, but for those that noise drowns.

    By the columns' products: exact enough for what is not, in half the time.
    """
    squared, axes = scipy.linalg.eigh(columns.T @ columns, check_finite=False)
    kept = squared > max(NEGLIGIBLE**2, ROUNDED * float(squared.max(initial=0.0)))
    size = np.sqrt(squared[kept])
    return columns @ (axes[:, kept] / size), size
