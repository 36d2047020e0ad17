"""Least squares where columns may depend on one another, and when what is left differs from nothing."""

import numpy as np
from scipy.stats import norm

from arm.model import Floats

#: Relative rounding of a sum of squares: some thousand additions in double precision. Columns that are this
#: near to depending on others, in terms of the normal equations, do so.
ROUNDED = 1e-12
#: As good as nothing: it keeps a quotient finite.
TINY = 1e-300
#: Probability with which what is nothing passes for nothing, the field's usual one, and its standard errors.
CONFIDENCE = 0.95
EQUAL_SIGMAS = float(norm.ppf(0.5 + 0.5 * CONFIDENCE))
#: Standard deviations at which one of a run's some thousand samples is hardly ever by chance: one in 16 000.
SIGMAS = 4.0
#: A variance exceeds another plainly if it is this multiple of it: 3 dB.
PLAINLY = 2.0
#: Trials are drawn anew so often for an interval (Efron and Tibshirani 1993: about 1000).
N_DRAWN = 1000
#: No direction loses more than this share of what tells it: where noise is all there is, nothing can be put right.
_MOST = 0.5


def scaled_lstsq(A: Floats, y: Floats) -> Floats:
    """Return the least-squares answer by the normal equations; see `solved`."""
    return solved(A.T @ A, A.T @ y)


def solved(gram: Floats, pull: Floats) -> Floats:
    """Return the answer to normal equations, columns scaled to length one first.

    Where columns depend on one another it is the shortest answer.

    Parameters
    ----------
    gram : (n, n)
    pull : (n,)
    """
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    told, axes = np.linalg.eigh(gram / np.outer(size, size))
    kept = told > ROUNDED * max(float(told.max(initial=0.0)), TINY)
    axes = axes[:, kept]
    return np.asarray(axes @ ((axes.T @ (pull / size)) / told[kept]) / size, dtype=np.float64)


def own_square(gram: Floats) -> float:
    """Return the square of the last column that no others make, by their products (n, n)."""
    others = gram[:-1, :-1]
    return max(0.0, float(gram[-1, -1] - gram[-1, :-1] @ solved(others, gram[:-1, -1])))


def compensated(gram: Floats, pull: Floats, noise_gram: Floats, noise_pull: Floats) -> Floats:
    """Return the answer to normal equations that noise has a part in.

    Parameters
    ----------
    gram, noise_gram : (k, k)
        Of the design, and of what noise makes of it.
    pull, noise_pull : (k,)
        The products with the right-hand side.
    """
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    told, axes = np.linalg.eigh(gram / np.outer(size, size))
    kept = told > ROUNDED * max(float(told.max(initial=0.0)), TINY)
    root = axes[:, kept] / np.sqrt(told[kept]) / size[:, None]  # root^T gram root = 1
    share, within = np.linalg.eigh(root.T @ noise_gram @ root)
    root = root @ within
    return np.asarray(root @ ((root.T @ (pull - noise_pull)) / (1.0 - np.minimum(share, _MOST))), dtype=np.float64)
