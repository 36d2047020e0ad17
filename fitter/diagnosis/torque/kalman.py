"""A Kalman filter in compiled loops: gains once a trial, innovations of any column."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled


@dataclass(frozen=True)
class Filter:
    """A Kalman filter whose gains do not depend on what is measured.

    Attributes
    ----------
    F, Q, P : (d, d)
        Transition, process noise, prior.
    C : (n, d)
    variance : (n,)
        Of the white noise [N^2 m^2].
    gain, S : (n, d), (n,)
        Gains and the innovations' variances.
    known : (n,) of bool
    """

    F: Floats
    Q: Floats
    P: Floats
    C: Floats
    variance: Floats
    gain: Floats
    S: Floats
    known: NDArray[np.bool_]

    def innovations(self, r: Floats, first: int = 0) -> Floats:
        """Return the standardised innovations of a residual, or of a column that is zero before its first row.

        Parameters
        ----------
        r : (m,)
            From the row `first` on.
        first : int
        """
        out = np.zeros(len(r))
        innovations(self.F, self.C, self.gain, self.S, self.known, r, first, out)
        return out


@compiled
def _carried(F: Floats, at: NDArray[np.int64], P: Floats, out: Floats) -> None:
    """Put ``(F P)'`` into an array; F is not zero at (row, column) only."""
    out[:] = 0.0
    for n in range(len(at)):
        i, k = at[n]
        for j in range(len(F)):
            out[j, i] += F[i, k] * P[k, j]


@compiled
def gains(
    F: Floats, Q: Floats, P: Floats, C: Floats, variance: Floats, known: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Return the gains and the innovations' variances; a row that is not known has gain 0 and variance 1."""
    n, d = C.shape
    gain, S = np.zeros((n, d)), np.ones(n)
    P, turned, p = P.copy(), np.zeros((d, d)), np.zeros(d)
    at = np.argwhere(F != 0.0)
    for k in range(n):
        if known[k]:
            S[k] = variance[k]
            p[:] = 0.0
            for i in range(d):
                for j in range(d):  # P is symmetric
                    p[j] += C[k, i] * P[i, j]
            for i in range(d):
                S[k] += C[k, i] * p[i]
            for i in range(d):
                gain[k, i] = p[i] / S[k]
                for j in range(d):
                    P[i, j] -= gain[k, i] * p[j]
        _carried(F, at, P, turned)
        _carried(F, at, turned, P)
        P += Q
    return gain, S


@compiled
def innovations(
    F: Floats, C: Floats, gain: Floats, S: Floats, known: NDArray[np.bool_], r: Floats, first: int, out: Floats
) -> None:
    """Put the standardised innovations of a column into an array like it: r[0] is in the row `first`."""
    d = C.shape[1]
    x, y = np.zeros(d), np.zeros(d)
    at = np.argwhere(F != 0.0)
    for row in range(len(r)):
        k = first + row
        out[row] = 0.0
        if known[k]:
            e = r[row]
            for i in range(d):
                e -= C[k, i] * x[i]
            out[row] = e / np.sqrt(S[k])
            for i in range(d):
                x[i] += gain[k, i] * e
        y[:] = 0.0
        for n in range(len(at)):
            i, j = at[n]
            y[i] += F[i, j] * x[j]
        x[:] = y
