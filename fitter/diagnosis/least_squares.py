"""Least squares where columns may depend on one another."""

import numpy as np

from arm.model import Floats

#: Columns that are this near to depending on others, in terms of the normal equations, do so.
_DEPENDENT = 1e-12


def scaled_lstsq(A: Floats, y: Floats) -> Floats:
    """Return the least-squares answer by the normal equations, columns scaled to length one first.

    Where columns depend on one another it is the shortest answer.
    """
    size = np.sqrt(np.einsum("ij,ij->j", A, A))
    size[size == 0.0] = 1.0
    G = (A.T @ A) / np.outer(size, size)
    told, axes = np.linalg.eigh(G)
    kept = told > _DEPENDENT * max(float(told.max(initial=0.0)), 1e-300)
    axes = axes[:, kept]
    return np.asarray(axes @ ((axes.T @ ((A.T @ y) / size)) / told[kept]) / size, dtype=np.float64)
