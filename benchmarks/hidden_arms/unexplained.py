"""How much of a torque no rigid arm with plain friction explains: an inverse dynamics of its own, fitted.

The torque is linear in each link's mass, first moments and inertia about its joint. The columns come from
Newton's and Euler's equations of one link at a time and share nothing with the simulation's Lagrange equations.
"""

import numba
import numpy as np
import scipy.signal
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Least eigenvalue, beside the largest, of a combination of columns that counts as there.
RANK = 1e-11


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _inertial_columns(lengths, gravity, q, dq, ddq, out):
    n_sample, n = q.shape
    at = np.zeros((n, 2))
    for s in range(n_sample):
        turn, speed, gain = 0.0, 0.0, 0.0
        px, py, ax, ay = 0.0, 0.0, -gravity[0], -gravity[1]
        for i in range(n):
            turn, speed, gain = turn + q[s, i], speed + dq[s, i], gain + ddq[s, i]
            c, r, L = np.cos(turn), np.sin(turn), lengths[i]
            at[i, 0], at[i, 1] = px, py
            for k in range(4):
                along, across = (1.0, 0.0) if k == 1 else (0.0, 1.0)
                fx, fy, moment = 0.0, 0.0, 0.0  # force, and moment about this link's own joint
                if k == 0:
                    fx, fy = ax, ay
                elif k == 3:
                    moment = gain
                else:
                    sx, sy = c * along - r * across, r * along + c * across
                    fx, fy = -gain * sy - speed * speed * sx, gain * sx - speed * speed * sy
                    moment = sx * ay - sy * ax
                for j in range(i + 1):
                    out[s, j, 4 * i + k] = moment + (px - at[j, 0]) * fy - (py - at[j, 1]) * fx
            ax += -gain * L * r - speed * speed * L * c
            ay += gain * L * c - speed * speed * L * r
            px, py = px + L * c, py + L * r


def columns(lengths: Floats, gravity: Floats, q: Floats, dq: Floats, ddq: Floats) -> Floats:
    """Return the torques of unit parameters of a planar arm.

    Parameters
    ----------
    lengths : (n,)
    gravity : (2,)
    q, dq, ddq : (n_sample, n)

    Returns
    -------
    (n_sample, n, 6 n)
        Of every link its mass, first moments and inertia about its joint; then viscous and Coulomb friction.
    """
    n_sample, n = q.shape
    out = np.zeros((n_sample, n, 6 * n))
    _inertial_columns(lengths, gravity, *(np.ascontiguousarray(x) for x in (q, dq, ddq)), out)
    each = np.arange(n)
    out[:, each, 4 * n + each], out[:, each, 5 * n + each] = dq, np.sign(dq)
    return out


def fit(Y: Floats, tau: Floats, used: NDArray[np.bool_]) -> Floats:
    """Return the least-squares parameters of least norm, each joint weighed by its own torque.

    Parameters
    ----------
    Y : (n_sample, n, n_column)
    tau : (n_sample, n)
    used : (n_sample, n)
        Which equations count.
    """
    size = rms(tau, used)
    weight = used / np.where(size > 0.0, size, 1.0)  # a joint that never moves has no equation
    A, b = (Y * weight[..., None]).reshape(-1, Y.shape[-1]), (tau * weight).ravel()
    scale = np.sqrt(np.sum(A * A, axis=0))
    scale[scale == 0.0] = 1.0
    A = A / scale
    values, vectors = np.linalg.eigh(A.T @ A)
    there = values > RANK * values[-1]
    solved: Floats = vectors[:, there] @ ((vectors[:, there].T @ (A.T @ b)) / values[there]) / scale
    return solved


def rms(values: Floats, used: NDArray[np.bool_]) -> Floats:
    """Return the root mean square of each column over the rows that count."""
    found: Floats = np.sqrt(np.sum(values**2 * used, axis=0) / np.maximum(np.count_nonzero(used, axis=0), 1))
    return found


def lowpass(values: Floats, rate_hz: float, corner_hz: float) -> Floats:
    """Pass columns through a Butterworth filter of second order, forwards and backwards."""
    sections = scipy.signal.butter(2, corner_hz, fs=rate_hz, output="sos")
    filtered: Floats = scipy.signal.sosfiltfilt(sections, values, axis=0)
    return filtered
