"""A Kalman filter in compiled loops: gains once a trial, innovations of many columns."""

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
    variance : float
        Of the white noise [N^2 m^2].
    gain, S : (n, d), (n,)
        Gains and the innovations' variances.
    known : (n,) of bool
    """

    F: Floats
    Q: Floats
    P: Floats
    C: Floats
    variance: float
    gain: Floats
    S: Floats
    known: NDArray[np.bool_]

    def whitened(self, columns: Floats, first: NDArray[np.int64], last: NDArray[np.int64]) -> Floats:
        """Return the standardised innovations of columns, each between its first and last (exclusive) row.

        Parameters
        ----------
        columns : (n, m)
            Zero before their first row.
        first, last : (m,)

        Returns
        -------
        (n, m)
        """
        rows = np.ascontiguousarray(columns.T)
        return np.asarray(_whitened(self.F, self.C, self.gain, self.S, self.known, rows, first, last).T)

    def innovations(self, r: Floats) -> Floats:
        """Return the standardised innovations (n,) of a residual (n,)."""
        return self.whitened(r[:, None], np.zeros(1, dtype=np.int64), np.full(1, len(r), dtype=np.int64))[:, 0]


@compiled
def _multiplied(F: Floats, P: Floats, out: Floats) -> None:
    """Put F P into an array; F is sparse."""
    d = len(F)
    out[:] = 0.0
    for i in range(d):
        for k in range(d):
            if F[i, k] != 0.0:
                for j in range(d):
                    out[i, j] += F[i, k] * P[k, j]


@compiled
def gains(
    F: Floats, Q: Floats, P: Floats, C: Floats, variance: float, known: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Return the gains and the innovations' variances; a row that is not known has gain 0 and variance 1."""
    n, d = C.shape
    gain, S = np.zeros((n, d)), np.ones(n)
    P, FP, p = P.copy(), np.zeros((d, d)), np.zeros(d)
    for k in range(n):
        if known[k]:
            S[k] = variance
            for i in range(d):
                p[i] = 0.0
                for j in range(d):
                    p[i] += P[i, j] * C[k, j]
                S[k] += C[k, i] * p[i]
            for i in range(d):
                gain[k, i] = p[i] / S[k]
                for j in range(d):
                    P[i, j] -= gain[k, i] * p[j]
        _multiplied(F, P, FP)  # P is symmetric: F P F' = F (F P)'
        _multiplied(F, FP.T, P)
        P += Q
    return gain, S


@compiled
def _whitened(
    F: Floats,
    C: Floats,
    gain: Floats,
    S: Floats,
    known: NDArray[np.bool_],
    columns: Floats,
    first: NDArray[np.int64],
    last: NDArray[np.int64],
) -> Floats:
    d = C.shape[1]
    out = np.zeros(columns.shape)
    x, y = np.zeros(d), np.zeros(d)
    for c in range(len(columns)):
        x[:] = 0.0
        for k in range(first[c], last[c]):
            if known[k]:
                e = columns[c, k]
                for i in range(d):
                    e -= C[k, i] * x[i]
                out[c, k] = e / np.sqrt(S[k])
                for i in range(d):
                    x[i] += gain[k, i] * e
            for i in range(d):
                y[i] = 0.0
                for j in range(d):
                    y[i] += F[i, j] * x[j]
            x[:] = y
    return out
