"""Slopes of the log density of a residual's innovations, by going back through the filter (adjoint).

All slopes cost as much as some runs of the filter, however many numbers its matrices are made of (mathematics.md,
"The missing torque over time"). A bar over a quantity, ``_bar`` here, is the log density's slope with it.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.torque.kalman import carried, gains, predicted, weighted_innovations
from limbcal.compiled import compiled


@compiled
def log_density(r: Floats, e: Floats, S: Floats, known: NDArray[np.bool_], nu: float) -> float:
    """Return the logarithm of Student's density of standardised innovations, but for its constant [nats]."""
    total = 0.0
    for k in range(len(r)):
        if known[k]:
            total -= 0.5 * (nu + 1.0) * np.log(1.0 + e[k] ** 2 / nu) + 0.5 * np.log(S[k])
    return total


@compiled
def log_density_slopes(
    F: Floats,
    Q: Floats,
    P: Floats,
    C: Floats,
    variance: Floats,
    known: NDArray[np.bool_],
    n_torque: int,
    r: Floats,
    nu: float,
) -> tuple[float, Floats, Floats, Floats, Floats, float]:
    """Return `log_density` of a filter's weighted innovations, and its slopes.

    Parameters
    ----------
    F, Q, P, C, variance, known
        As of `kalman.Filter`.
    n_torque : int
        The first states, which are torques, or in proportion to one.
    r : (n,) [N m]
    nu : float
        Degrees of freedom.

    Returns
    -------
    log_density : float
    F_bar, Q_bar, P_bar : (d, d)
        With F where it is not zero, Q, and the covariance before the first row.
    variance_bar : (n,)
    nu_bar : float
    """
    n, d = C.shape
    priors = np.zeros((n, d, d))
    gain, S, new_gain, new_ratio = gains(F, Q, P, C, variance, known, n_torque, priors)
    e, weighted = np.zeros(n), np.empty((n, d))
    weighted_innovations(F, C, gain, new_gain, new_ratio, S, known, r, nu, e, weighted)
    states = predicted(F, C, weighted, known, r)
    back = np.ascontiguousarray(F.T)
    at, at_back = np.argwhere(F != 0.0), np.argwhere(back != 0.0)
    fresh = np.argwhere(Q[:n_torque, :n_torque] != 0.0)
    F_bar, Q_bar, P_bar = np.zeros((d, d)), np.zeros((d, d)), np.zeros((d, d))
    variance_bar, nu_bar = np.zeros(n), 0.0
    x, x_bar, p_bar, P_new, turned = np.zeros(d), np.zeros(d), np.zeros(d), np.zeros((d, d)), np.zeros((d, d))
    for k in range(n - 1, -1, -1):
        for i in range(d):
            x[i] = states[k, i] + weighted[k, i] * e[k] * np.sqrt(S[k])
            for j in range(d):
                P_new[i, j] = priors[k, i, j] - gain[k, i] * gain[k, j] * S[k]
        carried(F, at, P_new, turned)  # (F P)'
        _through_step(F, at, x, turned, x_bar, P_bar, F_bar)
        Q_bar += P_bar
        carried(back, at_back, P_bar, turned)
        carried(back, at_back, turned, P_bar)
        if known[k]:
            own = gain[k], S[k], new_gain[k], new_ratio[k], weighted[k], e[k], nu
            through = _through_weights(C[k], Q, fresh, *own, x_bar, p_bar, Q_bar)
            row = C[k], gain[k], S[k], e[k]
            variance_bar[k] = through[2] + _through_gain(*row, *through[:2], x_bar, p_bar, P_bar)
            nu_bar += through[3]
    return log_density(r, e, S, known, nu), F_bar, Q_bar, P_bar, variance_bar, nu_bar


@compiled
def _through_step(
    F: Floats, at: NDArray[np.int64], x: Floats, turned: Floats, x_bar: Floats, P_bar: Floats, F_bar: Floats
) -> None:
    """Go back through the next row's state ``F x`` and, as far as F is concerned, covariance ``F P F' + Q``.

    ``turned`` is ``(F P)'``.
    """
    for m in range(len(at)):
        i, j = at[m]
        F_bar[i, j] += x_bar[i] * x[j]
        for q in range(len(x)):
            F_bar[i, j] += 2.0 * P_bar[i, q] * turned[j, q]
    x[:] = 0.0
    for m in range(len(at)):
        i, j = at[m]
        x[j] += F[i, j] * x_bar[i]
    x_bar[:] = x


@compiled
def _through_weights(
    C: Floats,
    Q: Floats,
    fresh: NDArray[np.int64],
    gain: Floats,
    S: float,
    new_gain: Floats,
    new_ratio: float,
    weighted: Floats,
    e: float,
    nu: float,
    x_bar: Floats,
    p_bar: Floats,
    Q_bar: Floats,
) -> tuple[float, float, float, float]:
    """Go back through a row's state ``x + G e sqrt(S)``, its G by eq. (m.1b), and its density.

    Slopes with the gain K are put into ``p_bar``; those with e, S, the variance and nu are returned.
    """
    root, w = np.sqrt(S), nu / (nu + e**2)
    mixed = w + (1.0 - w) * new_ratio
    by_G, by_difference, e_bar, S_bar = 0.0, 0.0, 0.0, -0.5 / S
    for i in range(len(C)):
        G_bar = x_bar[i] * e * root
        e_bar += x_bar[i] * weighted[i] * root
        S_bar += 0.5 * x_bar[i] * weighted[i] * e / root
        by_G += G_bar * weighted[i]
        by_difference += G_bar * (gain[i] - new_gain[i])
        p_bar[i] = G_bar * w / mixed
    w_bar = (by_difference - by_G * (1.0 - new_ratio)) / mixed
    ratio_bar = -by_G * (1.0 - w) / mixed
    e_bar -= ((nu + 1.0) / nu + 2.0 * w_bar * w / nu) * e * w
    nu_bar = (0.5 * (nu + 1.0) + w_bar * w) * (1.0 - w) / nu - 0.5 * np.log(1.0 + e**2 / nu)
    # What is new, of the torques alone: N = Q C / S, and its ratio (variance + C' Q C) / S.
    for m in range(len(fresh)):
        i, j = fresh[m]
        N_bar = x_bar[i] * e * root * (1.0 - w) / mixed
        Q_bar[i, j] += (N_bar + ratio_bar * C[i]) * C[j] / S
        S_bar -= N_bar * Q[i, j] * C[j] / S**2
    return e_bar, S_bar - ratio_bar * new_ratio / S, ratio_bar / S, nu_bar


@compiled
def _through_gain(
    C: Floats,
    gain: Floats,
    S: float,
    e: float,
    e_bar: float,
    S_bar: float,
    x_bar: Floats,
    p_bar: Floats,
    P_bar: Floats,
) -> float:
    """Go back through e = (r - C' x) / sqrt(S), K = P C / S, P - K S K' and S = variance + C' P C.

    The slope with the variance, which is that with S, is returned.
    """
    S_bar -= 0.5 * e * e_bar / S
    for i in range(len(C)):
        S_bar -= p_bar[i] * gain[i] / S
        p_bar[i] /= S
        for j in range(len(C)):
            p_bar[i] -= 2.0 * P_bar[i, j] * gain[j]
            S_bar += gain[i] * P_bar[i, j] * gain[j]
    for i in range(len(C)):
        p_bar[i] += S_bar * C[i]
        x_bar[i] -= C[i] * e_bar / np.sqrt(S)
    for i in range(len(C)):
        for j in range(len(C)):
            P_bar[i, j] += 0.5 * (p_bar[i] * C[j] + p_bar[j] * C[i])
    return S_bar
