"""A Kalman filter for Student's noise, in compiled loops: gains once a trial, innovations of any column.

The torque that is new in a row, process noise and white noise, has the variance that the model gives it, divided
by a number lambda that goes to zero for an outlier. So an outlier is what is new there, and moves what was known
of the states before as little as it has weight (mathematics.md, "The missing torque over time").
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from limbcal.compiled import compiled


@dataclass(frozen=True)
class Filter:
    """A Kalman filter whose gains are those of rows without outliers, or of rows weighted as in one residual.

    Attributes
    ----------
    F, Q, P : (d, d)
        Transition, process noise, prior.
    C : (n, d)
    variance : (n,)
        Of the white noise [N^2 m^2].
    gain, S : (n, d), (n,)
        Gains and the innovations' variances.
    new_gain, new_ratio : (n, d), (n,)
        Of the torque that is new in each row: covariance with the states, and variance, both in units of S.
    known : (n,) of bool
    """

    F: Floats
    Q: Floats
    P: Floats
    C: Floats
    variance: Floats
    gain: Floats
    S: Floats
    new_gain: Floats
    new_ratio: Floats
    known: NDArray[np.bool_]

    def weighted(self, r: Floats, nu: float) -> "Filter":
        """Return the filter with the gains that the rows of a residual have, by their weights.

        It is linear: innovations of a residual and a column together are the sum of either's.

        Parameters
        ----------
        r : (n,) [N m]
        nu : float
            Degrees of freedom of Student's distribution.
        """
        return replace(self, gain=self._weighted(r, nu)[1])

    def weighted_innovations(self, r: Floats, nu: float) -> Floats:
        """Return the standardised innovations of a residual, its rows weighted by it, (n,)."""
        return self._weighted(r, nu)[0]

    def _weighted(self, r: Floats, nu: float) -> tuple[Floats, Floats]:
        gain, e = np.empty_like(self.gain), np.zeros(len(r))
        new = self.gain, self.new_gain, self.new_ratio, self.S
        weighted_innovations(self.F, self.C, *new, self.known, r, nu, e, gain)
        return e, gain

    def innovations(self, r: Floats, first: int = 0) -> Floats:
        """Return the standardised innovations of a residual, or of a column that is zero before its first row.

        Parameters
        ----------
        r : (m,)
            From the row `first` on.
        first : int
        """
        out = np.zeros(len(r))
        innovations(self.F, self.C, self.gain, self.S, self.known, r, first, np.zeros(self.C.shape[1]), out)
        return out

    def predicted(self, r: Floats) -> Floats:
        """Return the states that are expected before each row of a residual, (n, d)."""
        return np.asarray(predicted(self.F, self.C, self.gain, self.known, r))


@compiled
def carried(F: Floats, at: NDArray[np.int64], P: Floats, out: Floats) -> None:
    """Put ``(F P)'`` into an array; F is not zero at (row, column) only."""
    out[:] = 0.0
    for n in range(len(at)):
        i, k = at[n]
        for j in range(len(F)):
            out[j, i] += F[i, k] * P[k, j]


@compiled
def gains(
    F: Floats,
    Q: Floats,
    P: Floats,
    C: Floats,
    variance: Floats,
    known: NDArray[np.bool_],
    n_torque: int,
    priors: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return `Filter`'s gain, S, new_gain and new_ratio; a row that is not known has gains 0 and variance 1.

    The first ``n_torque`` states are torques, or in proportion to one. The states' covariance before each row is
    put into ``priors``, (n, d, d), or (0, d, d) if nobody needs it.
    """
    n, d = C.shape
    gain, S, new_gain, new_ratio = np.zeros((n, d)), np.ones(n), np.zeros((n, d)), np.ones(n)
    P, turned, p = P.copy(), np.zeros((d, d)), np.zeros(d)
    at, fresh = np.argwhere(F != 0.0), np.argwhere(Q[:n_torque, :n_torque] != 0.0)
    for k in range(n):
        if k < len(priors):
            priors[k] = P
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
            new_ratio[k] = variance[k] / S[k]
            for m in range(len(fresh)):
                i, j = fresh[m]
                new_gain[k, i] += Q[i, j] * C[k, j] / S[k]
                new_ratio[k] += C[k, i] * Q[i, j] * C[k, j] / S[k]
        carried(F, at, P, turned)
        carried(F, at, turned, P)
        P += Q
    return gain, S, new_gain, new_ratio


@compiled
def innovations(
    F: Floats,
    C: Floats,
    gain: Floats,
    S: Floats,
    known: NDArray[np.bool_],
    r: Floats,
    first: int,
    state: Floats,
    out: Floats,
) -> None:
    """Put the standardised innovations of a column into an array like it: r[0] is in the row `first`.

    Before it a state is expected.
    """
    x, y = state.copy(), np.zeros(C.shape[1])
    at = np.argwhere(F != 0.0)
    for row in range(len(r)):
        k = first + row
        out[row] = 0.0
        if known[k]:
            e = _innovation(C[k], x, r[row])
            out[row] = e / np.sqrt(S[k])
            for i in range(len(x)):
                x[i] += gain[k, i] * e
        _step(F, at, x, y)


@compiled
def response(
    F: Floats,
    C: Floats,
    gain: Floats,
    S: Floats,
    known: NDArray[np.bool_],
    column: Floats,
    first: int,
    settled: float,
) -> Floats:
    """Return the standardised innovations of a column, and of the zeros behind it until they have settled, (k,).

    Parameters
    ----------
    column : (m,)
        From the row `first` on; zero before it and behind it.
    settled : float
        They have settled when as many known rows as the column has have less than this part of the largest.
    """
    x, y, out = np.zeros(C.shape[1]), np.zeros(C.shape[1]), np.zeros(len(C) - first)
    at = np.argwhere(F != 0.0)
    largest, calm = 0.0, 0
    for row in range(len(out)):
        k = first + row
        if known[k]:
            e = _innovation(C[k], x, column[row] if row < len(column) else 0.0)
            out[row] = e / np.sqrt(S[k])
            for i in range(len(x)):
                x[i] += gain[k, i] * e
            largest = max(largest, abs(out[row]))
            calm = calm + 1 if abs(out[row]) < settled * largest else 0
            if row >= len(column) and calm >= len(column):
                return out[: row + 1]
        _step(F, at, x, y)
    return out


@compiled
def predicted(F: Floats, C: Floats, gain: Floats, known: NDArray[np.bool_], r: Floats) -> Floats:
    """Return the states that are expected before each row of a residual, (n, d)."""
    n, d = C.shape
    states, x, y = np.zeros((n, d)), np.zeros(d), np.zeros(d)
    at = np.argwhere(F != 0.0)
    for k in range(n):
        states[k] = x
        if known[k]:
            x += gain[k] * _innovation(C[k], x, r[k])
        _step(F, at, x, y)
    return states


@compiled
def weighted_innovations(
    F: Floats,
    C: Floats,
    gain: Floats,
    new_gain: Floats,
    new_ratio: Floats,
    S: Floats,
    known: NDArray[np.bool_],
    r: Floats,
    nu: float,
    out: Floats,
    weighted: Floats,
) -> None:
    """Put a residual's standardised innovations, and the gains of its rows, eq. (m.1b), into arrays like them."""
    x, y = np.zeros(C.shape[1]), np.zeros(C.shape[1])
    at = np.argwhere(F != 0.0)
    for k in range(len(r)):
        out[k] = 0.0
        weighted[k] = 0.0
        if known[k]:
            e = _innovation(C[k], x, r[k])
            out[k] = e / np.sqrt(S[k])
            weight = nu / (nu + out[k] ** 2)  # lambda
            variance = weight + (1.0 - weight) * new_ratio[k]
            for i in range(len(x)):
                weighted[k, i] = (weight * gain[k, i] + (1.0 - weight) * new_gain[k, i]) / variance
                x[i] += weighted[k, i] * e
        _step(F, at, x, y)


@compiled
def _innovation(C: Floats, x: Floats, r: float) -> float:
    for i in range(len(x)):
        r -= C[i] * x[i]
    return r


@compiled
def _step(F: Floats, at: NDArray[np.int64], x: Floats, y: Floats) -> None:
    """Replace a state by ``F x``; F is not zero at (row, column) only, y is room for it."""
    y[:] = 0.0
    for n in range(len(at)):
        i, j = at[n]
        y[i] += F[i, j] * x[j]
    x[:] = y
