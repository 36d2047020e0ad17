"""Least squares where columns may depend on one another."""

import numpy as np

from arm.model import Floats

#: Columns that are this near to depending on others, in terms of the normal equations, do so.
_DEPENDENT = 1e-12
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
    kept = told > _DEPENDENT * max(float(told.max(initial=0.0)), 1e-300)
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
    kept = told > _DEPENDENT * max(float(told.max(initial=0.0)), 1e-300)
    root = axes[:, kept] / np.sqrt(told[kept]) / size[:, None]  # root^T gram root = 1
    share, within = np.linalg.eigh(root.T @ noise_gram @ root)
    root = root @ within
    return np.asarray(root @ ((root.T @ (pull - noise_pull)) / (1.0 - np.minimum(share, _MOST))), dtype=np.float64)
