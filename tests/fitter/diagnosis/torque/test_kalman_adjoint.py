"""Slopes by the adjoint against differences of the log density."""

import numpy as np
import pytest

from fitter.diagnosis.torque.kalman import Filter, gains
from fitter.diagnosis.torque.kalman_adjoint import log_density, log_density_slopes

N, NU = 50, 3.0


def model() -> dict[str, np.ndarray]:
    """Return a filter's matrices: of a torque that decays, an oscillator, and an angle's noise."""
    rng = np.random.default_rng(1)
    F = np.zeros((4, 4))
    F[0, 0] = 0.9
    F[1:3, 1:3] = [[0.8, 0.3], [-0.2, 0.7]]
    Q, P = np.zeros((2, 4, 4))
    Q[:3, :3], P[:3, :3] = np.diag([0.3, 0.1, 0.2]), np.diag([2.0, 0.5, 0.4])
    Q[1, 2] = Q[2, 1] = 0.05
    Q[3, 3], P[3, 3] = 0.4, 0.4
    C = np.concatenate([rng.normal(size=(N, 3)), np.ones((N, 1))], axis=1)
    return {"F": F, "Q": Q, "P": P, "C": C, "variance": 0.5 + rng.random(N)}


def residual() -> tuple[np.ndarray, np.ndarray]:
    """Return a residual with outliers, and what of it is known."""
    rng = np.random.default_rng(2)
    known = np.ones(N, dtype=bool)
    known[[0, 13, 14, N - 1]] = False
    return np.asarray(rng.standard_t(1.5, size=N)), known


def density(nu: float = NU, **matrices: np.ndarray) -> float:
    r, known = residual()
    F, Q, P, C, variance = ({**model(), **matrices}[name] for name in ("F", "Q", "P", "C", "variance"))
    own = gains(F, Q, P, C, variance, known, 3, np.zeros((0, 4, 4)))
    e = Filter(F, Q, P, C, variance, *own, known).weighted_innovations(r, nu)
    return log_density(r, e, own[1], known, nu)


def difference(name: str, at: tuple[int, ...], step: float = 1e-6) -> float:
    """Return the slope with an entry of a matrix, a symmetric one's both entries together."""
    ahead, behind = model()[name], model()[name]
    for place in {at, at[::-1]} if name in "QP" else {at}:
        ahead[place] += step
        behind[place] -= step
    return (density(**{name: ahead}) - density(**{name: behind})) / (2.0 * step)


def test_slopes_are_the_differences_of_the_density():
    r, known = residual()
    m = model()
    value, F_bar, Q_bar, P_bar, variance_bar, nu_bar = log_density_slopes(
        m["F"], m["Q"], m["P"], m["C"], m["variance"], known, 3, r, NU
    )
    assert value == pytest.approx(density())
    both = {"F": F_bar, "Q": Q_bar + Q_bar.T, "P": P_bar + P_bar.T}
    for name, slopes in both.items():
        for at in np.argwhere(m[name] != 0.0):
            i, j = map(int, at)
            half = 0.5 if name in "QP" and i == j else 1.0
            assert half * slopes[i, j] == pytest.approx(difference(name, (i, j)), rel=1e-5, abs=1e-7), name
    for k in (0, 1, 20, N - 2, N - 1):
        assert variance_bar[k] == pytest.approx(difference("variance", (k,)), rel=1e-5, abs=1e-7)
    assert nu_bar == pytest.approx((density(NU + 1e-6) - density(NU - 1e-6)) / 2e-6, rel=1e-5)
