"""Linear least squares under linear inequalities (Lawson and Hanson 1974, chapter 23: problem LSI)."""

import numpy as np
import scipy
import scipy.linalg
from numpy.typing import NDArray

from arm.model import Floats


def constrained_step(A: Floats, b: Floats, g: Floats, G: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the x that makes ``|A x - b|`` least where ``g + G x >= 0``.

    Parameters
    ----------
    A, b : (n_row, n), (n_row,)
        Of full rank where a limit binds.
    g, G : (m,), (m, n)

    Returns
    -------
    x : (n,)
        Zero where no x is allowed.
    binds : (m,) bool
        Which limits hold it back.
    """
    free = np.asarray(np.linalg.lstsq(A, b, rcond=None)[0], dtype=np.float64)
    if np.all(g + G @ free >= 0.0):
        return free, np.zeros(len(g), dtype=np.bool_)
    Q, R = np.linalg.qr(A)
    y = Q.T @ b
    # With z = R x - y it is the point nearest to the origin where E z >= f (problem LDP), which is found among
    # the non-negative combinations of E's rows.
    E = scipy.linalg.solve_triangular(R, G.T, trans="T").T
    f = -g - E @ y
    length = np.maximum(np.linalg.norm(E, axis=1), 1e-300)
    E, f = E / length[:, None], f / length
    unit = max(1.0, float(np.abs(f).max()))
    rows = np.vstack([E.T, f / unit])
    target = np.zeros(len(rows))
    target[-1] = 1.0
    u, _ = scipy.optimize.nnls(rows, target)
    residual = rows @ u - target
    if not residual[-1] < -1e-12:
        return np.zeros(A.shape[1]), u > 0.0
    z = -unit * residual[:-1] / residual[-1]
    return np.asarray(scipy.linalg.solve_triangular(R, y + z), dtype=np.float64), u > 0.0
